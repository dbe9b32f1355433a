"""The arithmetic of `LimitFilter`: the torque nearest to a law's that keeps the joints' bounds.

Of the torques `τ` within their limits the one nearest to the law's `τ_law` is sought,

    min ½ (τ - τ_law)ᵀ M⁻¹ (τ - τ_law)   with   lower ≤ M⁻¹ (τ - h) ≤ upper

(Gauss' principle of least constraint), joint by joint until it stands. Its solution is what ideal
stops would do: a joint that is within its bounds keeps the law's torque, bit for bit.
`limit_bounds` says where the bounds come from.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.safety.limit_bounds import (
    BRAKE,
    BRAKING,
    DRIFT,
    EXCESS,
    LEAST,
    LEAST_TORQUE,
    MOST,
    MOST_TORQUE,
    A,
    V,
    bound_accelerations,
    find_drift,
    learn_error,
    remember,
)
from fotsmc_pin.control.small_matrices import cholesky, invert, solve

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

SWEEPS = 60
"""Most sweeps over the joints; a handful is usual."""
SETTLED = 1e-5
"""A sweep is the last that changes no joint's acceleration by this share of its deceleration."""
TOLERANCE = 1e-3
"""Share of a joint's deceleration by which an acceleration may exceed its bound."""
HALVINGS = 4
"""Steps of the search for how much the law has to give way; 1/16 is close enough."""
REST = 0.05
"""Time constant with which joints are braked that have to give way [s]."""


@kernel
def filtered(
    period: float,
    law: Array,
    M: Array,
    h: Array,
    late: Array,
    looks_late: bool,
    torque: Array,
    work: Array,
    table: Array,
) -> float:
    """Write the torque to send, that of the law and what was added to it into `torque` (3, nv).

    Args:
        period: of a tick [s].
        law: torque of the law (nv,) [N·m, N].
        M: mass matrix (nv, nv).
        h: `C v + G` (nv,).
        late: torque that the last acceleration asks at the latest moment (nv,).
        looks_late: whether `late` is known; what a late torque does is left out where it is not.
        torque: overwritten (3, nv).
        work: room for a factor, an inverse and a vector, (2 nv + 1, nv).
        table: see `limit_bounds`.

    Returns:
        By how much the worst bound is exceeded, as a share of the joint's deceleration; 0 where
        all are kept.
    """
    n = law.size
    tau, factor, a = torque[0], work[:n], table[A]
    cholesky(M, factor)
    if looks_late:
        find_drift(late, M, h, factor, table)
    else:
        table[DRIFT] = 0.0
    learn_error(period, table)
    bound_accelerations(period, table)
    within = True
    for i in range(n):
        tau[i] = law[i]
        a[i] = law[i] - h[i]
        table[EXCESS, i] = 0.0
        within = within and table[LEAST_TORQUE, i] <= law[i] <= table[MOST_TORQUE, i]
    solve(factor, a)
    for i in range(n):
        within = within and table[LEAST, i] <= a[i] <= table[MOST, i]
    worst: float = 0.0
    if not within:
        inverse = work[n : 2 * n]
        invert(factor, inverse)
        worst = nearest_torque(tau, law, M, h, inverse, work[2 * n], table)
    remember(table)
    for i in range(n):
        torque[1, i], torque[2, i] = law[i], tau[i] - law[i]
    return worst


@kernel
def nearest_torque(
    tau: Array, law: Array, M: Array, h: Array, inverse: Array, aim: Array, table: Array
) -> float:
    """Write the torque nearest to the law's that keeps the bounds; return as `filtered` does.

    Where a joint's own torque does not suffice, the others help: all of the law's torques give way
    to those that brake every joint, no further than needed.
    """
    n = tau.size
    worst: float = sweep(tau, law, h, inverse, table)
    if worst <= TOLERANCE:
        return 0.0
    for i in range(n):
        wanted = h[i]
        for j in range(n):
            wanted += M[i, j] * slowing(j, table)
        table[BRAKE, i] = min(max(wanted, table[LEAST_TORQUE, i]), table[MOST_TORQUE, i])
    too_little, enough, share = 0.0, 1.0, 1.0
    for _ in range(1 + HALVINGS):
        for i in range(n):
            aim[i] = law[i] + share * (table[BRAKE, i] - law[i])
        worst = sweep(tau, aim, h, inverse, table)
        if worst <= TOLERANCE:
            enough = share
        elif share == 1.0:
            return float(worst)
        else:
            too_little = share
        share = 0.5 * (too_little + enough)
    if worst > TOLERANCE:
        for i in range(n):
            aim[i] = law[i] + enough * (table[BRAKE, i] - law[i])
        sweep(tau, aim, h, inverse, table)
    return 0.0


@kernel
def slowing(j: int, table: Array) -> float:
    """Return the acceleration that slows a joint down, within its bounds."""
    wanted = min(max(-table[V, j] / REST, -table[BRAKING, j]), table[BRAKING, j])
    return float(min(max(wanted, table[LEAST, j]), table[MOST, j]))


@kernel
def sweep(tau: Array, aim: Array, h: Array, inverse: Array, table: Array) -> float:
    """Find the torque nearest to `aim` that keeps the bounds; return the worst excess."""
    n, a = tau.size, table[A]
    for i in range(n):
        tau[i] = min(max(aim[i], table[LEAST_TORQUE, i]), table[MOST_TORQUE, i])
    for i in range(n):
        a[i] = 0.0
        for j in range(n):
            a[i] += inverse[i, j] * (tau[j] - h[j])
    for _ in range(SWEEPS):
        moves = False
        for i in range(n):
            own = inverse[i, i]
            by_aim = a[i] + own * (aim[i] - tau[i])
            wanted = aim[i]
            if by_aim > table[MOST, i]:
                wanted += (table[MOST, i] - by_aim) / own
            elif by_aim < table[LEAST, i]:
                wanted += (table[LEAST, i] - by_aim) / own
            least, most = table[LEAST_TORQUE, i], table[MOST_TORQUE, i]
            step = min(max(wanted, least), most) - tau[i]
            if step != 0.0:
                tau[i] = tau[i] + step if wanted != aim[i] else min(max(wanted, least), most)
                moves = moves or abs(step) * own > SETTLED * table[BRAKING, i]
                for j in range(n):
                    a[j] += inverse[i, j] * step
        if not moves:
            break
    worst: float = 0.0
    for i in range(n):
        beyond: float = max(a[i] - table[MOST, i], table[LEAST, i] - a[i], 0.0)
        table[EXCESS, i] = beyond / table[BRAKING, i]
        worst = max(worst, table[EXCESS, i])
    return float(worst)
