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
    import clarabel

    to_belief = np.linalg.inv(fit.factor)
    precision = to_belief.T @ fit.precision @ to_belief
    scale = 1.0 / np.sqrt(np.diag(precision))
    quadratic = precision * np.outer(scale, scale)
    linear = -scale * (precision @ fit.theta)
    tables, sides, cones = [], [], []
    for k, size in enumerate(sizes):
        table = np.zeros((len(TRIANGLE), parameters.size))
        table[:, parameters.body(k)] = -PSEUDO
        mass = nominal[10 * k]
        tables.append(table * scale)
        sides.append(-triangle(least_matter(mass, size)))
        cones.append(clarabel.PSDTriangleConeT(4))
    held = np.zeros(parameters.size, dtype=bool)
    for name in parameters.own:
        if name in NOT_NEGATIVE:
            held[parameters.groups[name]] = True
    tables.append(-np.diag(scale)[held])
    sides.append(np.zeros(np.count_nonzero(held)))
    cones.append(clarabel.NonnegativeConeT(np.count_nonzero(held)))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solution = clarabel.DefaultSolver(
        triu(csc_array(quadratic)).tocsc(),
        linear,
        csc_array(np.vstack(tables)),
        np.concatenate(sides),
        cones,
        settings,
    ).solve()
    found = scale * np.array(solution.x)
    if not np.all(np.isfinite(found)) or "Solved" not in str(solution.status):
        raise FotsmcError(f"no possible bodies found that explain the log ({solution.status})")
    # The solver's cones hold to its tolerance only.
    own = slice(10 * parameters.joints, parameters.size)
    found[own] = np.where(held[own], np.maximum(found[own], 0.0), found[own])
    return _pulled_inside(found, parameters, nominal)


def _pulled_inside(theta: Array, parameters: Parameters, nominal: Array) -> Array:
    """Return the parameters with impossible bodies moved towards the nominal ones."""
    theta = theta.copy()
    for k in range(parameters.joints):
        place, share = parameters.body(k), 1e-9
        while not can_exist(theta[place]):
            theta[place] += share * (nominal[place] - theta[place])
            share *= 10.0
    return theta


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
