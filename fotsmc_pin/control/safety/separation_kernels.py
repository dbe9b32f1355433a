"""The arithmetic of `Separation`: which pairs may be near, gradients, bounds, the program."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.safety.limit_bounds import (
    LEAST,
    LEAST_TORQUE,
    MOST,
    MOST_TORQUE,
    A,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

    Whole: TypeAlias = NDArray[np.int64]

FARTHEST = 0.25
"""Pairs are looked at from this distance beyond the clearance on [m]."""
SHARE = 0.25
"""Share of the joints' decelerations that is counted on in the direction of a distance."""
LEAST_DECELERATION = 0.2
"""Deceleration of a distance in the least favourable direction [m/s²]."""
TOLERANCE = 1e-3
"""Share of a distance's deceleration by which a bound may be exceeded."""
UNBOUNDED = 1e30

REACH, SLOPE = range(2)
"""Tables of the pairs, each (pairs, nv) [m]: the largest speed of a distance per speed of a joint,
which is never exceeded, and the usual one."""
BOUND, CLEARANCE, NEEDS = range(3)
"""Rows of the pairs' numbers: what the distance is at least, what it must be, and twice the
deceleration that it has."""


@kernel
def nearest_pairs(
    v: Array, dt: float, horizon: float, tables: Array, pairs: Array, nearest: Whole
) -> int:
    """Let the pairs' least distances shrink by a tick, and list those that may be near.

    Args:
        v: velocity (nv,).
        dt: time since the last tick [s].
        horizon: of the bounds [s].
        tables: `REACH` and `SLOPE` (2, pairs, nv).
        pairs: the pairs' numbers (3, pairs).
        nearest: the pairs that may be near, those with the least distance first; overwritten.

    Returns:
        How many are listed; no more than there is room for.
    """
    found = 0
    for k in range(pairs.shape[1]):
        fastest, usual = 0.0, 0.0
        for j in range(v.size):
            fastest += tables[REACH, k, j] * abs(v[j])
            usual += tables[SLOPE, k, j] * abs(v[j])
        pairs[BOUND, k] -= fastest * dt
        way = 0.02 + usual * 5.0 * horizon + usual * usual / pairs[NEEDS, k]
        if pairs[BOUND, k] >= pairs[CLEARANCE, k] + min(way, FARTHEST):
            continue
        place = found
        while place > 0 and pairs[BOUND, nearest[place - 1]] > pairs[BOUND, k]:
            if place < nearest.size:
                nearest[place] = nearest[place - 1]
            place -= 1
        if place < nearest.size:
            nearest[place] = k
            found = min(found + 1, nearest.size)
    return found


@kernel
def gradients(J: Array, found: Array, sides: Array, rows: Array, gaps: Array) -> None:
    """Write the gradients of distances and what is left of each.

    Args:
        J: velocity of the world's origin as a point of the last link, and angular velocity, per
            joint (6, nv).
        found: of each distance its normal, a point of the first shape, and what is left (k, 7).
        sides: per joint 1 where it moves the second shape alone, -1 the first, 0 (k, nv).
        rows: overwritten (k, nv).
        gaps: overwritten (k,).
    """
    for k in range(gaps.size):
        x, y, z = found[k, 0], found[k, 1], found[k, 2]
        px, py, pz = found[k, 3], found[k, 4], found[k, 5]
        # A point moves by ω × p besides; (ω × p) · n = ω · (p × n), alike for both points.
        cx, cy, cz = py * z - pz * y, pz * x - px * z, px * y - py * x
        for j in range(J.shape[1]):
            slope = x * J[0, j] + y * J[1, j] + z * J[2, j]
            slope += cx * J[3, j] + cy * J[4, j] + cz * J[5, j]
            rows[k, j] = sides[k, j] * slope
        gaps[k] = found[k, 6]


@kernel
def distances_are_kept(
    v: Array,
    rows: Array,
    gaps: Array,
    braking: Array,
    late: float,
    horizon: float,
    least: Array,
    own: Array,
    table: Array,
) -> bool:
    """Write the least acceleration of each distance; return whether the joints' give it.

    Args:
        v: velocity (nv,).
        rows: gradients of the distances (k, nv).
        gaps: what is left of each (k,).
        braking: decelerations of the joints (nv,).
        late: longest delay of a measurement [s].
        horizon: of the bounds [s].
        least: overwritten (k,).
        own: deceleration of each distance, overwritten (k,).
        table: of the joints; see `limit_bounds`.
    """
    are_kept = True
    slow = 4.0 * horizon
    for k in range(gaps.size):
        closing, strength, given = 0.0, 0.0, 0.0
        for j in range(v.size):
            closing -= rows[k, j] * v[j]
            strength += abs(rows[k, j]) * braking[j]
            given += rows[k, j] * table[A, j]
        own[k] = max(SHARE * strength, LEAST_DECELERATION)
        ahead = max(closing, 0.0)
        gap, bend = gaps[k] - late * ahead, own[k] * slow * slow
        if gap > bend:
            allowed = math.sqrt(2.0 * own[k] * (gap - 0.5 * bend))
            slope = own[k] / allowed
        else:
            slope = 1.0 / slow
            allowed = gap * slope
        least[k] = slope * ahead - (allowed - closing) / horizon
        are_kept = are_kept and given >= least[k] - TOLERANCE * own[k]
    return are_kept


@kernel
def fill_program(
    M: Array,
    h: Array,
    law: Array,
    rows: Array,
    least: Array,
    table: Array,
    matrix: Array,
    limits: Array,
) -> None:
    """Write the program `min ½ aᵀ M a + fᵀ a` with `lower ≤ (a, A a) ≤ upper`.

    Args:
        M: mass matrix (nv, nv).
        h: `C v + G` (nv,).
        law: torque of the law (nv,).
        rows: gradients of the distances (k, nv).
        least: least acceleration of each (k,).
        table: of the joints; see `limit_bounds`.
        matrix: `A`: `M`, then the gradients; its first nv + k rows are overwritten.
        limits: `f`, `lower` and `upper` as rows, of which the first 2 nv + k are overwritten.
    """
    n = h.size
    f, lower, upper = limits[0], limits[1], limits[2]
    for i in range(n):
        f[i] = h[i] - law[i]
        # A bound that the joints cannot keep is exceeded no further than without distances.
        lower[i] = max(min(table[LEAST, i], table[A, i]), -UNBOUNDED)
        upper[i] = min(max(table[MOST, i], table[A, i]), UNBOUNDED)
        lower[n + i] = max(table[LEAST_TORQUE, i] - h[i], -UNBOUNDED)
        upper[n + i] = min(table[MOST_TORQUE, i] - h[i], UNBOUNDED)
        for j in range(n):
            matrix[i, j] = M[i, j]
    for k in range(least.size):
        lower[2 * n + k], upper[2 * n + k] = max(least[k], -UNBOUNDED), UNBOUNDED
        for j in range(n):
            matrix[n + k, j] = rows[k, j]
