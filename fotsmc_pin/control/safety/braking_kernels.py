"""The arithmetic of `BrakingPath`: decelerations of least way within the torque limits."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

START, SPEED, RATE, WAY, UNKNOWN, BRAKING, JERK, FIRST = range(8)
"""Rows of a path's table (13, nv): speed that it begins with, velocity, acceleration, way from
where it began, torque that the model does not explain, deceleration that is striven for, jerk, and
speed of the arm where it began."""
KEPT = 8
LOWEST, HIGHEST, TRIED, BRAKES, ASKED = range(KEPT, KEPT + 5)
"""Further rows, which a search overwrites: bounds of the decelerations, those that are tried, the
accelerations that they are, and their torques."""
ROWS = 13

SHARE = 0.95
"""Share of the effort limits that braking may take; the rest is for following the path."""
LADEN = 1.2
"""Inertia that braking is planned for, over the nominal arm's: a payload may be there."""
LEARNT = 100.0
"""Rate at which the path learns what torque the model does not explain [1/s]."""
ROOM, GENTLE = 0.2, 0.3
"""The way that a stop may well take [rad, m], and the time [s]: it is not harder than that."""
LONGEST = 0.5
"""The slowest braking, for an arm that is too weak to hold itself while it brakes [s]."""
HARDER = 2.0
"""Times as hard as usual at most may a joint brake where that relieves others."""
GENTLE_RISE, URGENT_RISE, RISE = 0.3, 0.1, 0.15
"""Share of the time of a gentle stop in which its deceleration rises; of one in which the law is in
doubt, which may be blind and knows no more later; and of one that the torque limits make long,
where what rises late is way lost. The last is of the hardest deceleration."""
RATE_SHARE = 0.75
"""Share of the torque rate that the rise of the deceleration may take."""
EASING = 0.02
"""Time in which the acceleration at the start is faded out, at most [s]."""
HALVINGS, FINER, STEPS = 12, 0.01, 8
"""Steps of the first search for the least way; step, as a share, and number of steps by which the
way may change in a tick."""
SWEEPS, STEP, SETTLED = 30, 0.1, 1e-3
"""Sweeps over the joints in the search for decelerations; the largest step of one, as a share of
its hardest, so that none is changed a lot that helps little; and the share of a limit by which a
torque may exceed it."""
AT_REST, NO_WAY = 1e-3, 1e-6
"""Speed [rad/s, m/s] and way [rad, m] that do not count."""
FASTER, NOISE = 1.005, 0.005
"""Times the speed at the start, and speed beyond it [rad/s, m/s], from which on a joint is faster
than it was."""
UNBOUNDED = 1e9
"""Way within which every stop is [rad, m]."""


@kernel
def common_time(motion: Array, shortest: float) -> float:
    """Return the time in which all joints brake where their torques suffice [s]."""
    fastest = 0.0
    for i in range(motion.shape[1]):
        fastest = max(fastest, motion[START, i])
    return min(max(shortest, 2.0 * ROOM / max(fastest, 1e-9)), max(shortest, GENTLE))


@kernel
def way_in(motion: Array, time: float) -> float:
    """Return the way of the fastest joint that brakes evenly in this time [rad, m]."""
    fastest = 0.0
    for i in range(motion.shape[1]):
        fastest = max(fastest, motion[START, i])
    return 0.5 * fastest * time + NO_WAY


@kernel
def speed_left(motion: Array) -> float:
    """Return which share is left of a torque that grows with the square of the speeds."""
    left, whole = 0.0, 0.0
    for i in range(motion.shape[1]):
        left += motion[SPEED, i] * motion[SPEED, i]
        whole += motion[START, i] * motion[START, i]
    return float(min(left / max(whole, NO_WAY * NO_WAY), 1.0))


@kernel
def is_faster(v: Array, motion: Array) -> bool:
    """Whether a joint at the velocity `v` (nv,) is faster than the arm was where its path began."""
    most = 0.0
    for i in range(v.size):
        most = max(most, abs(v[i]) - FASTER * motion[FIRST, i])
    return most > NOISE


@kernel
def drawn(
    M: Array,
    h: Array,
    limit: Array,
    torque_rate: Array,
    shortest: float,
    is_urgent: bool,
    motion: Array,
) -> float:
    """Begin a path, and return the least way of the joint that moves farthest [rad, m].

    Args:
        M: mass matrix (nv, nv).
        h: `C v + G` (nv,).
        limit: effort limits (nv,).
        torque_rate: largest rates of the torques (nv,); inf for none.
        shortest: least time in which a joint brakes, unless that relieves others [s].
        is_urgent: whether the deceleration is to rise soon, also where torques suffice.
        motion: the path's table; velocity, acceleration and unknown torque are where it begins,
            all else is overwritten.
    """
    n = motion.shape[1]
    for i in range(n):
        motion[START, i] = abs(motion[SPEED, i]) + EASING * abs(motion[RATE, i])
        motion[WAY, i], motion[BRAKING, i] = 0.0, 0.0
        motion[JERK, i] = abs(motion[RATE, i]) / EASING
    time = common_time(motion, shortest)
    least, most = way_in(motion, time), way_in(motion, max(time, LONGEST))
    rise = URGENT_RISE if is_urgent else GENTLE_RISE
    limit_jerk(M, torque_rate, rise * time * time, motion)
    sweeps = keeps_torque(least, M, h, limit, shortest, motion)
    if sweeps == 1:
        most = least
    else:
        limit_jerk(M, torque_rate, RISE * time * shortest / HARDER, motion)
        sweeps = keeps_torque(UNBOUNDED, M, h, limit, shortest, motion)
        for _ in range(HALVINGS):
            middle = 0.5 * (least + most)
            sweeps = keeps_torque(middle, M, h, limit, shortest, motion)
            if sweeps > 0:
                most = middle
            else:
                least = middle
    return most


@kernel
def limit_jerk(M: Array, torque_rate: Array, rise: float, motion: Array) -> None:
    """Write the joints' jerks into `motion`: their speed at the start over `rise` [s²].

    They are less where the torques that they ask for would change faster than they may.
    """
    n, share = motion.shape[1], 1.0
    for i in range(n):
        motion[JERK, i] = max(motion[START, i] / rise, motion[JERK, i])
    for i in range(n):
        asked = 0.0
        for j in range(n):
            asked += abs(M[i, j]) * motion[JERK, j]
        share = min(share, RATE_SHARE * torque_rate[i] / max(asked, 1e-9))
    for i in range(n):
        motion[JERK, i] *= share


@kernel
def advanced(
    M: Array,
    h: Array,
    tau: Array,
    limit: Array,
    torque_rate: Array,
    shortest: float,
    weight: float,
    dt: float,
    bound: float,
    motion: Array,
) -> float:
    """Advance a path by a tick of `dt` seconds, and return the way that is now the least.

    Args:
        M: mass matrix (nv, nv).
        h: `C v + G` (nv,).
        tau: the torque that acted last (nv,).
        limit: effort limits (nv,).
        torque_rate: largest rates of the torques (nv,); inf for none.
        shortest: least time in which a joint brakes, unless that relieves others [s].
        weight: of this tick in what is learnt from `tau`; 0 for nothing.
        dt: the tick [s].
        bound: the way that was the least a tick ago [rad, m].
        motion: the path's table.
    """
    n = motion.shape[1]
    for i in range(n):
        motion[ASKED, i] = tau[i] - h[i]
    add_inertia(-LADEN, M, motion[RATE], motion[ASKED])
    for i in range(n):
        motion[UNKNOWN, i] += weight * (motion[ASKED, i] - motion[UNKNOWN, i])
    time = common_time(motion, shortest)
    least, now, sweeps = way_in(motion, time), bound, 0
    for k in range(STEPS):
        now = max(least, bound * (1.0 + FINER * (k - 1)))
        sweeps = keeps_torque(now, M, h, limit, shortest, motion)
        if sweeps > 0:
            break
    if sweeps == 0:
        sweeps = keeps_torque(UNBOUNDED, M, h, limit, shortest, motion)
    if sweeps != 1:
        limit_jerk(M, torque_rate, RISE * time * shortest / HARDER, motion)
    for i in range(n):
        v, a, jerk = motion[SPEED, i], motion[RATE, i], motion[JERK, i]
        # At this jerk the deceleration falls to zero together with the speed.
        size = min(motion[BRAKING, i], math.sqrt(2.0 * jerk * abs(v)))
        wanted = -math.copysign(size, v)
        a = min(max(wanted, a - jerk * dt), a + jerk * dt)
        after = v + a * dt
        if after * v <= 0.0 and abs(a) <= 2.0 * jerk * dt:
            after, a = 0.0, 0.0
        motion[WAY, i] += 0.5 * (v + after) * dt
        motion[SPEED, i], motion[RATE, i] = after, a
    return now


@kernel
def keeps_torque(
    way: float, M: Array, h: Array, limit: Array, shortest: float, motion: Array
) -> int:
    """Write the decelerations of a stop within `way` into `motion`, if the torques allow them.

    A joint that has moved `s_i` of its way must have at least `d_i = v_i² / (2 (way - s_i))`, and
    may have more. Returned are the sweeps of the search, 1 where all can brake in the common time;
    0 where the torques allow none. An unbounded way is always taken, with the decelerations whose
    torques are beyond the limits least.
    """
    n = motion.shape[1]
    lowest, highest, d = motion[LOWEST], motion[HIGHEST], motion[TRIED]
    time = common_time(motion, shortest)
    for i in range(n):
        v = motion[SPEED, i]
        size, left = abs(v), way - math.copysign(1.0, v) * motion[WAY, i]
        lowest[i], highest[i], d[i] = 0.0, 0.0, 0.0
        if size == 0.0:
            continue
        if left <= NO_WAY and size > AT_REST:
            return 0
        needed = 0.5 * size * size / max(left, NO_WAY)
        even = motion[START, i] / time
        highest[i] = max(even, HARDER * motion[START, i] / shortest)
        if needed > highest[i] and size > AT_REST:
            return 0
        fading = math.sqrt(2.0 * motion[JERK, i] * size)
        highest[i] = min(highest[i], fading)
        lowest[i] = min(max(needed, motion[START, i] / max(time, LONGEST)), highest[i])
        d[i] = min(max(even, lowest[i]), highest[i])
    sweeps = suffices(M, h, limit, motion)
    is_taken = sweeps > 0 or way == UNBOUNDED
    for i in range(n):
        motion[BRAKING, i] = d[i] if is_taken else motion[BRAKING, i]
    return sweeps


@kernel
def add_inertia(factor: float, M: Array, a: Array, torque: Array) -> None:
    """Add `factor M a` to a torque (nv,)."""
    for i in range(a.size):
        for j in range(a.size):
            torque[i] += factor * M[i, j] * a[j]


@kernel
def suffices(M: Array, h: Array, limit: Array, motion: Array) -> int:
    """Change the decelerations tried within their bounds until the torque suffices.

    Joint by joint, each takes a step that lessens the sum of squares of what is beyond the limits,
    as shares of these. Returned are the sweeps over the joints; 0 where they all do not help.
    """
    n, lowest, highest = motion.shape[1], motion[LOWEST], motion[HIGHEST]
    d, asked = motion[TRIED], motion[ASKED]
    for i in range(n):
        asked[i] = h[i] + motion[UNKNOWN, i]
        motion[BRAKES, i] = -math.copysign(d[i], motion[SPEED, i])
    add_inertia(LADEN, M, motion[BRAKES], asked)
    for k in range(SWEEPS):
        worst = 0.0
        for i in range(n):
            worst = max(worst, abs(asked[i]) / (SHARE * limit[i]) - 1.0)
        if worst <= SETTLED:
            return k + 1
        for j in range(n):
            slope, bend = 0.0, 0.0
            turn = math.copysign(LADEN, motion[SPEED, j])
            for i in range(n):
                size = SHARE * limit[i]
                beyond = asked[i] - min(max(asked[i], -size), size)
                if beyond != 0.0:
                    per = -M[i, j] * turn / size
                    slope += per * beyond / size
                    bend += per * per
            if bend > 0.0:
                most = STEP * highest[j]
                step = min(max(d[j] - slope / bend, lowest[j]), highest[j]) - d[j]
                step = min(max(step, -most), most)
                d[j] += step
                for i in range(n):
                    asked[i] -= M[i, j] * turn * step
    return 0
