"""Search for the motion of an `Excitation`: from random starts downhill, then inside all bounds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.excitation_cost import PRIOR

if TYPE_CHECKING:
    from collections.abc import Callable

    from fotsmc_pin.references.excitation_cost import Cost
    from fotsmc_pin.types import Array

STARTS = 2
"""Random starts of which the best end is kept."""
CANDIDATES = 20
"""Random motions of which each start takes the best."""
DRAWS = 500
"""Middles tried for one that the arm can hold without touching itself."""
PENALTIES = ((30.0, 50), (3000.0, 90))
"""Weight of broken bounds, and evaluations spent with it, one after the other."""
CHECK_STEP = 0.005
"""Times at which the final motion is checked are so far apart [s]."""
TIGHT = 0.998
"""Share of the bounds that the final motion keeps then: between those times it may do more."""
SHRINK = 0.96
"""Factor by which a motion that breaks a bound is made smaller, again and again."""


def designed(cost: Cost, rng: np.random.Generator, report: Callable[[float], None]) -> Array:
    """Return coefficients (nv, 1 + free) of a motion that shows the parameters and keeps bounds.

    Args:
        cost: what to make small.
        rng: of the starts.
        report: is told the fraction done.

    Raises:
        ArgumentError: no pose in the middle of the ranges can be held, or none is free of
            collision.
    """
    steps = STARTS * sum(count for _, count in PENALTIES)
    done = 0

    def told(flat: Array) -> tuple[float, Array]:
        nonlocal done
        done += 1
        report(min(done / steps, 1.0))
        return cost(flat)

    ends = []
    for _ in range(STARTS):
        start = _start(cost, rng)
        found = start.ravel()
        for penalty, evaluations in PENALTIES:
            cost.penalty = penalty
            found = minimize(
                told,
                found,
                jac=True,
                method="L-BFGS-B",
                options={"maxfun": evaluations, "maxiter": evaluations},
            ).x
        try:
            ends.append(inside(cost, found.reshape(cost.shape)))
        except ArgumentError:  # Its middle drifted out of bounds; that of the start has room.
            ends.append(inside(cost, start))
    return min(ends, key=lambda end: variance(cost, end))


def variance(cost: Cost, coefficients: Array) -> float:
    """Return the sum of variances `tr (BᵀYᵀYB)⁻¹` that a motion leads to."""
    sizes = np.linalg.eigvalsh(cost.information(coefficients))
    return float(np.sum(1.0 / (sizes + PRIOR)))


def random_motion(cost: Cost, rng: np.random.Generator, middle: Array) -> Array:
    """Return coefficients of random series around a middle (nv,), as large as ranges allow."""
    coefficients = np.zeros(cost.shape)
    coefficients[:, 0] = (middle - cost.middle) / cost.half
    coefficients[:, 1:] = rng.standard_normal((cost.shape[0], cost.shape[1] - 1))
    return fitted(cost, coefficients)


def fitted(cost: Cost, coefficients: Array, share: float = 0.95) -> Array:
    """Return the series with every joint's amplitude as large as its own bounds allow."""
    x, v, a = cost.motion(coefficients, cost.check_bases(CHECK_STEP))
    middle = cost.middle + cost.half * coefficients[:, 0]
    up, down = (x - middle).max(axis=0), (middle - x).max(axis=0)
    factors = [
        (cost.room.upper - middle) / np.maximum(up, 1e-12),
        (middle - cost.room.lower) / np.maximum(down, 1e-12),
        cost.room.velocity / np.maximum(np.abs(v).max(axis=0), 1e-12),
        cost.room.acceleration / np.maximum(np.abs(a).max(axis=0), 1e-12),
    ]
    grown = coefficients.copy()
    grown[:, 1:] *= share * np.maximum(np.min(factors, axis=0), 0.0)[:, None]
    return grown


def inside(cost: Cost, coefficients: Array) -> Array:
    """Return the motion, made smaller joint by joint and then as a whole until it keeps bounds.

    Raises:
        ArgumentError: not even a hundredth of it does.
    """
    bases = cost.check_bases(CHECK_STEP)
    kept = coefficients.copy()
    kept[:, 0] = np.clip(kept[:, 0], -0.999, 0.999)
    largest = fitted(cost, kept, share=TIGHT)
    smaller = np.abs(largest[:, 1:]).max(axis=1) < np.abs(kept[:, 1:]).max(axis=1)
    kept[smaller] = largest[smaller]
    while np.abs(kept[:, 1:]).max() > 1e-3:
        x, v, a = cost.motion(kept, bases)
        q = cost.configurations(x)
        if _within_effort(cost, q, v, a) and not any(map(cost.collision.collides, q)):
            return kept
        kept[:, 1:] *= SHRINK
    raise ArgumentError(
        "arm", cost.arm.name, "no motion keeps its bounds; give it more effort_share or less margin"
    )


def _within_effort(cost: Cost, q: Array, v: Array, a: Array) -> bool:
    arm, bound = cost.arm, TIGHT * cost.room.effort
    friction = arm.damping * v + arm.friction * np.sign(v)
    for row in range(len(q)):
        effort = arm.inverse_dynamics(q[row], v[row], a[row])
        if np.any(np.abs(effort + friction[row]) > bound):
            return False
    return True


def _start(cost: Cost, rng: np.random.Generator) -> Array:
    motions = [random_motion(cost, rng, _middle(cost, rng)) for _ in range(CANDIDATES)]
    return min(motions, key=lambda motion: variance(cost, motion))


def _middle(cost: Cost, rng: np.random.Generator) -> Array:
    """Return joint positions (nv,) that can be held with effort to spare, free of collision."""
    arm, least, lightest = cost.arm, np.inf, None
    for _ in range(DRAWS):
        x = cost.room.draw(rng)
        q = arm.from_joint_positions(x)
        load = float(np.max(np.abs(arm.gravity(q)) / cost.room.effort))
        if load < min(least, 0.98) and not cost.collision.collides(q):
            least, lightest = load, x
        if least < 0.7:
            break
    if lightest is None:
        raise ArgumentError(
            "arm",
            arm.name,
            f"none of {DRAWS} poses is free of collision and held by the share of the effort "
            "limits in use; raise effort_share, or effort_limit when you load the arm",
        )
    return lightest
