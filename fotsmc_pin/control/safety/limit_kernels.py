"""The arithmetic of `LimitFilter`: bounds of joints' accelerations, and the torque that keeps them.

A joint that moves at `v` towards an end at the distance `d` can still brake at `β` if `v ≤ V(d)`,

    V(d) = sqrt(2 β (d - d₀/2))  for d > d₀ = β T_p²,    V(d) = d / T_p  for less,

whose slope is continuous. `V` is kept as a barrier: the gap `V(d) - v` may close no faster than
with the time constant `T`, which bounds the acceleration,

    a ≤ (V(d) - v) / T - V'(d) v,      a ≤ (v_max - v) / T,

and alike towards the other end. What is measured is old by the delay of the loop, of which only the
longest is known: the bounds are those of the worst of all delays up to it, each as predicted
from the accelerations that were sent meanwhile.

Of the torques `τ` within their limits the one nearest to the law's `τ_law` is sought,

    min ½ (τ - τ_law)ᵀ M⁻¹ (τ - τ_law)   with   lower ≤ M⁻¹ (τ - h) ≤ upper

(Gauss' principle of least constraint), joint by joint until it stands. Its solution is what ideal
stops would do: a joint that is within its bounds keeps the law's torque, bit for bit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.safety.small_matrices import cholesky, invert, solve

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

    Whole: TypeAlias = NDArray[np.int64]

SWEEPS = 60
"""Most sweeps over the joints; a handful is usual."""
SETTLED = 1e-5
"""A sweep is the last that changes no joint's acceleration by this share of its deceleration."""
TOLERANCE = 1e-3
"""Share of a joint's deceleration by which an acceleration may exceed its bound."""
HALVINGS = 4
"""Steps of the search for how much the law has to give way; 1/16 is close enough."""
LEARNING = 2.0
"""Time constant with which the model's error is followed, in horizons of the bounds."""
REST = 0.05
"""Time constant with which joints are braked that have to give way [s]."""

# Rows of the filter's table: constants, what a tick brings, what it gives.
LOWER, UPPER, SPEED, BRAKING, ACCELERATION, LAG = range(6)
X, V, LEAST_TORQUE, MOST_TORQUE = range(6, 10)
LEAST, MOST, A, BRAKE, EXCESS, LAST_V, ERROR = range(10, 17)
PENDING = 17
"""First of the rows of accelerations that were sent, the newest first; all but the oldest may not
yet act."""


@kernel
def read_state(q: Array, v: Array, nq: int, state: Array, places: Whole, table: Array) -> bool:
    """Take in a measurement, and return True, if it has the right size and is finite."""
    n = table.shape[1]
    if q.size != nq or v.size != n:
        return False
    for j in range(nq):
        if not math.isfinite(q[j]):
            return False
    for j in range(n):
        if not math.isfinite(v[j]):
            return False
    state[0, :nq] = q
    for j in range(n):
        state[1, j] = v[j]
        table[X, j], table[V, j] = q[places[j]], v[j]
    return True


@kernel
def filtered(
    period: float, tau: Array, law: Array, M: Array, h: Array, work: Array, table: Array
) -> float:
    """Write the torque to send into `tau` (nv,).

    Args:
        period: of a tick [s].
        tau: overwritten (nv,) [N·m, N].
        law: torque of the law (nv,).
        M: mass matrix (nv, nv).
        h: `C v + G` (nv,).
        work: room for a factor, an inverse and a vector, (2 nv + 1, nv).
        table: see the rows above.

    Returns:
        By how much the worst bound is exceeded, as a share of the joint's deceleration; 0 where
        all are kept.
    """
    n = tau.size
    learn_error(period, table)
    bound_accelerations(period, table)
    factor, a = work[:n], table[A]
    cholesky(M, factor)
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
    return worst


@kernel
def learn_error(period: float, table: Array) -> None:
    """Follow by how much joints accelerate more than the nominal arm would."""
    delays = table.shape[0] - PENDING - 1
    sent = PENDING + (delays + 1) // 2
    share = 1.0 / (1.0 + LEARNING * (delays + 3))
    for j in range(table.shape[1]):
        seen = (table[V, j] - table[LAST_V, j]) / period
        table[ERROR, j] += share * (seen - table[sent, j] - table[ERROR, j])
        table[LAST_V, j] = table[V, j]


@kernel
def bound_accelerations(period: float, table: Array) -> None:
    """Write the least and the most acceleration of each joint."""
    delays = table.shape[0] - PENDING - 1
    for j in range(table.shape[1]):
        x, v, lag = table[X, j], table[V, j], table[LAG, j]
        lowest = highest = x
        slowest = fastest = v
        gained, moved = 0.0, 0.0
        for k in range(delays):
            gained += period * table[PENDING + k, j]
            moved += period * period * (k + 0.5) * table[PENDING + k, j]
            at = x + (k + 1) * period * v + moved
            lowest, highest = min(lowest, at), max(highest, at)
            slowest, fastest = min(slowest, v + gained), max(fastest, v + gained)
        horizon = (delays + 3) * period + lag
        most = room(table[UPPER, j] - highest, fastest, horizon, j, table)
        least = -room(lowest - table[LOWER, j], -slowest, horizon, j, table)
        cap = table[ACCELERATION, j]
        most -= max(table[ERROR, j], 0.0)
        least -= min(table[ERROR, j], 0.0)
        most, least = min(max(most, -cap), cap), min(max(least, -cap), cap)
        if least > most:  # both ends are too near: brake towards the middle between the bounds
            least = most = 0.5 * (least + most)
        table[LEAST, j], table[MOST, j] = least, most


@kernel
def room(gap: float, speed: float, horizon: float, j: int, table: Array) -> float:
    """Return the most acceleration towards an end at the distance `gap`, at `speed` towards it."""
    most = (table[SPEED, j] - speed) / horizon
    if gap == math.inf:
        return float(most)
    braking, slow, ahead = table[BRAKING, j], 4.0 * horizon, max(speed, 0.0)
    gap -= ahead * table[LAG, j]
    bend = braking * slow * slow
    if gap > bend:
        allowed = math.sqrt(2.0 * braking * (gap - 0.5 * bend))
        slope = braking / allowed
    else:
        slope = 1.0 / slow
        allowed = gap * slope
    return float(min(most, (allowed - speed) / horizon - slope * ahead))


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


@kernel
def remember(table: Array) -> None:
    """Keep the accelerations that are sent as the newest of those that may not yet act."""
    for k in range(table.shape[0] - 1, PENDING, -1):
        table[k] = table[k - 1]
    table[PENDING] = table[A]
