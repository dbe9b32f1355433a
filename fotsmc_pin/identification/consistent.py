"""The most likely parameters that matter can have: a semidefinite program.

A body is possible when its pseudo-inertia, the second moments of its mass about the joint's origin
with the first moments and the mass beside them (4, 4), has no eigenvalue below zero: that is a
positive mass and the triangle inequality at once (Wensing, Kim, Slotine, IEEE Robotics and
Automation Letters, 2018). It is linear in the ten parameters. So the fit, which is quadratic,
becomes a convex program with one solution, whatever the start: `min ½ (θ - θ₀)ᵀ A (θ - θ₀)` with
`θ₀` and `A` the linear fit and its precision. Armature and friction are not negative.

Log-Cholesky parameters, which make every number a possible body, were compared with it; the page
"Identify your arm" has the figures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from scipy.sparse import csc_array, triu

from fotsmc_pin.errors import FotsmcError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.identification.fit import Fit
    from fotsmc_pin.identification.regressor import Parameters
    from fotsmc_pin.types import Array

NOT_NEGATIVE = ("armature", "damping", "friction", "stribeck")
LIGHTEST = 0.02
"""A body keeps at least this share of its nominal mass."""
THINNEST = 1e-3
"""A body is nowhere thinner than its size times this."""
TRIANGLE = [(row, column) for column in range(4) for row in range(column + 1)]
"""Entries of a symmetric matrix, in the solver's order."""


def consistent(fit: Fit, parameters: Parameters, nominal: Array, sizes: Array) -> Array:
    """Return the most likely parameters (p,) whose bodies can exist.

    Args:
        fit: the linear fit.
        parameters: their order.
        nominal: parameters of bodies that can exist (p,).
        sizes: a length of each body (nv,) [m].

    Raises:
        FotsmcError: the solver gave up.
    """
    to_belief = np.linalg.inv(fit.factor)
    held = np.zeros(parameters.size, dtype=bool)
    for name in parameters.own:
        if name in NOT_NEGATIVE:
            held[parameters.groups[name]] = True
    least = [least_matter(nominal[10 * k], size) for k, size in enumerate(sizes)]
    found = nearest(fit.theta, to_belief.T @ fit.precision @ to_belief, least, held)
    for k in range(parameters.joints):
        place = parameters.body(k)
        found[place] = pulled_inside(found[place], nominal[place])
    return found


def nearest(wanted: Array, precision: Array, least: Sequence[Array], held: np.ndarray) -> Array:
    """Return the possible parameters (p,) that are nearest to those wanted.

    Args:
        wanted: parameters (p,), ten of each body first.
        precision: by which distance is measured (p, p).
        least: of each body the pseudo-inertia (4, 4) that it has at the least.
        held: which parameters are not negative (p,).

    Raises:
        FotsmcError: the solver gave up.
    """
    import clarabel

    size = wanted.size
    scale = 1.0 / np.sqrt(np.diag(precision))
    tables, sides, cones = [], [], []
    for k, matter in enumerate(least):
        table = np.zeros((len(TRIANGLE), size))
        table[:, 10 * k : 10 * k + 10] = -PSEUDO
        tables.append(table * scale)
        sides.append(-triangle(matter))
        cones.append(clarabel.PSDTriangleConeT(4))
    if held.any():
        tables.append(-np.diag(scale)[held])
        sides.append(np.zeros(np.count_nonzero(held)))
        cones.append(clarabel.NonnegativeConeT(int(np.count_nonzero(held))))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solution = clarabel.DefaultSolver(
        triu(csc_array(precision * np.outer(scale, scale))).tocsc(),
        -scale * (precision @ wanted),
        csc_array(np.vstack(tables)),
        np.concatenate(sides),
        cones,
        settings,
    ).solve()
    found = scale * np.array(solution.x)
    if not np.all(np.isfinite(found)) or "Solved" not in str(solution.status):
        raise FotsmcError(f"no possible bodies found that explain the log ({solution.status})")
    # The solver's cones hold to its tolerance only.
    return np.where(held, np.maximum(found, 0.0), found)


def pulled_inside(body: Array, possible: Array) -> Array:
    """Return the parameters (10,) of a body, moved towards a possible one until they are."""
    body, share = body.copy(), 1e-9
    while not can_exist(body):
        body += min(share, 1.0) * (possible - body)
        share *= 10.0
    return body


def least_matter(mass: float, size: float) -> Array:
    """Return the pseudo-inertia (4, 4) that a body has at the least."""
    thin = mass * (THINNEST * size) ** 2
    return np.diag([thin, thin, thin, LIGHTEST * mass])


def pseudo_inertia(dynamic: Array) -> Array:
    """Return the pseudo-inertia (4, 4) of ten parameters."""
    return np.array(pin.PseudoInertia.FromDynamicParameters(dynamic).toMatrix())


def triangle(matrix: Array) -> Array:
    """Return a symmetric matrix (4, 4) as the solver's vector (10,), which keeps lengths."""
    return np.array(
        [matrix[i, j] * (1.0 if i == j else np.sqrt(2.0)) for i, j in TRIANGLE], dtype=np.float64
    )


PSEUDO = np.column_stack([triangle(pseudo_inertia(unit)) for unit in np.eye(10)])
"""From ten parameters to the solver's vector of their pseudo-inertia (10, 10)."""


def can_exist(dynamic: Array) -> bool:
    """Return whether matter with these ten parameters can exist."""
    return bool(np.linalg.eigvalsh(pseudo_inertia(dynamic))[0] > 0.0)
