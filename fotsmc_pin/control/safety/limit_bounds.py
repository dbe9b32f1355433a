"""The arithmetic of `LimitFilter`: which accelerations keep an arm's joints within their limits.

A joint that moves at `v` towards an end at the distance `x` can still brake at `β` if `v ≤ V(x)`,

    V(x) = sqrt(2 β (x - x₀/2))  for x > x₀ = β T_p²,    V(x) = x / T_p  for less,

whose slope is continuous. `V` is kept as a barrier: the gap `V(x) - v` may close no faster than
with the time constant `T`, which bounds the acceleration,

    a ≤ (V(x) - v) / T - V'(x) v,      a ≤ (v_max - v) / T,

and alike towards the other end. What is measured is old by the delay of the loop, of which only the
longest, `d` ticks, is known: the bounds are those of the worst of all delays up to it, each as
predicted from the accelerations that were sent meanwhile.

A torque that is computed as `M a + h` and acts `k` ticks later meets another state, which a light
joint feels most. To first order it accelerates the arm by

    a - s D,    D = M⁻¹ (τ⁺(a) - M a - h),    s = (k + ½) / (d + 1),

where `τ⁺(a)` is the torque that the last acceleration asks at the latest moment, `d + 1` ticks
after the measurement, in the state predicted for it. The bounds hold for every `s` from 0 to 1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.small_matrices import solve

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

    Whole: TypeAlias = NDArray[np.int64]

LEARNING = 2.0
"""Time constant with which the model's error is followed, in horizons of the bounds."""
FAST = 0.5
"""Share of a joint's speed limit above which it is looked at what a late torque does."""
UNUSABLE, SLOW, QUICK = range(3)
"""What a measurement is: not to be used; of joints that are all slow; of others."""

# Rows of the filter's table: constants, what a tick brings, what it gives.
LOWER, UPPER, SPEED, BRAKING, ACCELERATION, LAG = range(6)
X, V, LEAST_TORQUE, MOST_TORQUE = range(6, 10)
LEAST, MOST, A, BRAKE, EXCESS, LAST_V, ERROR = range(10, 17)
WAY, LATE_V, PLACE, DRIFT = range(17, 21)
"""The way to the latest moment at which a torque may act, velocity and position there; `D`."""
PENDING = 21
"""First of the rows of accelerations that were sent, the newest first; all but the oldest may not
yet act. As many rows with the `D` of each follow."""


@kernel
def delay_of(table: Array) -> int:
    """Return the longest delay [ticks]."""
    return int((table.shape[0] - PENDING) // 2 - 1)


@kernel
def read_state(
    period: float, q: Array, v: Array, nq: int, state: Array, places: Whole, table: Array
) -> int:
    """Take in a measurement of the right size, if it is finite; return what it is."""
    n = table.shape[1]
    if q.size != nq or v.size != n:
        return UNUSABLE
    for j in range(nq):
        if not math.isfinite(q[j]):
            return UNUSABLE
    for j in range(n):
        if not math.isfinite(v[j]):
            return UNUSABLE
    state[0, :nq] = q
    for j in range(n):
        state[1, j] = v[j]
        table[X, j], table[V, j] = q[places[j]], v[j]
    return QUICK if look_ahead(period, table) else SLOW


@kernel
def look_ahead(period: float, table: Array) -> bool:
    """Write way and velocity to the latest moment; return whether a joint is fast until then."""
    delays, is_fast = delay_of(table), False
    late = (delays + 0.5) / (delays + 1)
    for j in range(table.shape[1]):
        gained, moved = 0.0, 0.0
        for k in range(delays):
            a = table[PENDING + k, j] - late * table[PENDING + delays + 1 + k, j]
            gained += period * a
            moved += period * period * (k + 0.5) * a
        next_one = period * table[PENDING, j]
        table[WAY, j] = (delays + 1) * period * table[V, j] + moved
        table[WAY, j] += period * (gained + 0.5 * next_one)
        table[LATE_V, j] = table[V, j] + gained + next_one
        table[PLACE, j] = table[X, j] + table[WAY, j]
        fast = FAST * table[SPEED, j]
        is_fast = is_fast or abs(table[V, j]) > fast or abs(table[LATE_V, j]) > fast
    return is_fast


@kernel
def look_back(period: float, table: Array) -> None:
    """Write the way and the velocity to which the torques should have led since the last tick."""
    delays = delay_of(table)
    middle = (delays + 1) // 2
    share = (middle + 0.5) / (delays + 1)
    for j in range(table.shape[1]):
        a = table[PENDING + middle, j] - share * table[PENDING + delays + 1 + middle, j]
        a += table[ERROR, j]
        table[WAY, j] = period * (table[V, j] + 0.5 * period * a)
        table[LATE_V, j] = table[V, j] + period * a


@kernel
def find_drift(late: Array, M: Array, h: Array, factor: Array, table: Array) -> None:
    """Write `D`, the acceleration that is lost between the first and the latest moment.

    Args:
        late: torque that the last acceleration asks at the latest moment (nv,).
        M: mass matrix at the first (nv, nv).
        h: `C v + G` there (nv,).
        factor: Cholesky's of `M` (nv, nv).
        table: see the rows above.
    """
    drift, a = table[DRIFT], table[PENDING]
    for i in range(h.size):
        drift[i] = late[i] - h[i]
        for j in range(h.size):
            drift[i] -= M[i, j] * a[j]
    solve(factor, drift)


@kernel
def learn_error(period: float, table: Array) -> None:
    """Follow by how much joints accelerate more than the nominal arm would at any delay."""
    delays = delay_of(table)
    middle = PENDING + (delays + 1) // 2
    share = 1.0 / (1.0 + LEARNING * (delays + 3))
    for j in range(table.shape[1]):
        seen = (table[V, j] - table[LAST_V, j]) / period
        sent, drift = table[middle, j], table[middle + delays + 1, j]
        explained = min(max(seen, sent - max(drift, 0.0)), sent - min(drift, 0.0))
        error = table[ERROR, j] + share * (seen - explained - table[ERROR, j])
        table[ERROR, j] = min(max(error, -table[ACCELERATION, j]), table[ACCELERATION, j])
        table[LAST_V, j] = table[V, j]


@kernel
def bound_accelerations(period: float, table: Array) -> None:
    """Write the least and the most acceleration of each joint."""
    delays = delay_of(table)
    for j in range(table.shape[1]):
        x, v, lag = table[X, j], table[V, j], table[LAG, j]
        lowest = highest = x
        slowest = fastest = v
        sent, drifted, moved, strayed = 0.0, 0.0, 0.0, 0.0
        for k in range(delays):
            a, d = table[PENDING + k, j], table[PENDING + delays + 1 + k, j]
            sent, drifted = sent + period * a, drifted + period * d
            moved += period * period * (k + 0.5) * a
            strayed += period * period * (k + 0.5) * d
            share = (k + 1.5) / (delays + 1)
            at, gained = x + (k + 1) * period * v + moved - share * strayed, sent - share * drifted
            lowest, highest = min(lowest, at), max(highest, at)
            slowest, fastest = min(slowest, v + gained), max(fastest, v + gained)
        horizon = (delays + 3) * period + lag
        most = room(table[UPPER, j] - highest, fastest, horizon, j, table)
        least = -room(lowest - table[LOWER, j], -slowest, horizon, j, table)
        cap, error, drift = table[ACCELERATION, j], table[ERROR, j], table[DRIFT, j]
        may_rise, may_fall = most >= cap, least <= -cap
        most = min(max(most, -cap), cap) - max(error, 0.0) + min(drift, 0.0)
        least = min(max(least, -cap), cap) - min(error, 0.0) + max(drift, 0.0)
        if least > most:  # not both can be kept for every delay
            if may_fall and not may_rise:
                least = most
            elif may_rise and not may_fall:
                most = least
            else:
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
def remember(table: Array) -> None:
    """Keep what is sent as the newest of what may not yet act."""
    size = delay_of(table) + 1
    for k in range(PENDING + size - 1, PENDING, -1):
        table[k] = table[k - 1]
        table[k + size] = table[k + size - 1]
    table[PENDING], table[PENDING + size] = table[A], table[DRIFT]
