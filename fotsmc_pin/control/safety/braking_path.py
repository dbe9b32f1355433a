"""`BrakingPath`: from any motion to rest, as fast as the torque limits allow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

SHARE = 0.92
"""Share of the effort limits that braking may take; the rest is for what the model lacks."""
LONGEST = 0.5
"""The slowest braking, for an arm that is too weak to hold itself while it brakes [s]."""
RISE = 0.15
"""Share of the braking time in which the deceleration rises, and in which it falls."""
LADEN = 1.2
"""Inertia that braking is planned for, over the nominal arm's: a payload may be there."""
PEAK = LADEN / (1.0 - RISE)
"""Torque that the height of the trapezium asks, over that of a constant deceleration."""
ROOM, GENTLE = 0.2, 0.3
"""The way that a stop may well take [rad, m], and the time [s]: it is not harder than that."""
EASING = 0.02
"""Time in which the acceleration at the start is faded out [s]."""
LONGER, ROUNDS = 1.05, 60
"""Factor and number of the steps in which the times are lengthened."""
HALVINGS, SWEEPS, SETTLED = 12, 60, 1e-3
"""Steps of the search for the least way, sweeps over the joints in each, and the share of a limit
by which a torque may exceed it."""
TARGETS = ("v", "a", "duration")


class BrakingPath(SharesNothing):
    """The path on which a safe stop brakes.

    The deceleration of a joint rises, stays and falls, a trapezium over its time `T`, of height
    `v0 / (0.85 T)`. The times are those with which the torques asked for are within 0.92 of the
    effort limits, a fifth of inertia beyond the nominal arm's included, and the joint that moves
    farthest moves least. The acceleration at
    the start, which is the motion's, is faded out over 20 ms, so that speed and acceleration have
    no step.

    Attributes:
        duration: `T` (nv,) [s].
    """

    def __init__(self, arm: Arm) -> None:
        """Make room for the path of an arm; `begin` draws it."""
        self._arm, n = arm, arm.nv
        self._q, self._t = np.zeros(arm.nq), 0.0
        self._v, self._a, self.duration = np.zeros(n), np.zeros(n), np.ones(n)

    def begin(self, start: tuple[Array, Array, Array], M: Array, load: Array, least: float) -> None:
        """Draw the path.

        Args:
            start: configuration (nq,), velocity (nv,) and acceleration (nv,) where it begins.
            M: mass matrix there (nv, nv).
            load: torque that the arm bears there beyond its inertia (nv,).
            least: least `T` [s].
        """
        self._q, self._v, self._a = (np.array(part, dtype=np.float64) for part in start)
        self._t, self.duration = 0.0, np.ones(self._arm.nv)
        braking_times(M, self._v, load, self._arm.effort_limit, least, self.duration)

    def advance(self, dt: float) -> tuple[Array, Array, Array]:
        """Return `q` (nq,), `v` and `a` (nv,) after another `dt` seconds."""
        self._t += dt
        way, speed, rate = np.zeros((3, self._arm.nv))
        on_path(self._t, self._v, self._a, self.duration, way, speed, rate)
        return self._arm.integrate(self._q, way), speed, rate

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        rows = (self._q, np.array(self._t), self._v, self._a, self.duration)
        return dict(zip(("q", "t", *TARGETS), rows, strict=True))

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        q = checks.finite_vector("q", present(arrays, "q"), self._arm.nq)
        t = checks.finite_number("t", present(arrays, "t"), at_least=0.0)
        v, a, duration = (
            checks.finite_vector(name, present(arrays, name), self._arm.nv) for name in TARGETS
        )
        self._q, self._t, self._v, self._a, self.duration = q, t, v, a, duration


@kernel
def braking_times(M: Array, v: Array, load: Array, limit: Array, shortest: float, T: Array) -> None:
    """Write the time in which each joint can brake from `v` into `T` (nv,) [s].

    The best of three: all joints have the same time; joints whose torque does not suffice are given
    longer, and all where that does not help, as the others' braking asks it of the joint; joints
    brake harder than they have to, where that relieves others.

    Args:
        M: mass matrix (nv, nv).
        v: velocity (nv,).
        load: torque that the arm bears beyond its inertia (nv,).
        limit: effort limits (nv,).
        shortest: least time [s].
        T: overwritten (nv,).
    """
    fastest = 0.0
    for i in range(v.size):
        fastest = max(fastest, abs(v[i]))
    gentle = 2.0 * ROOM / max(fastest, 1e-9)
    start = min(max(shortest, gentle), max(shortest, GENTLE))
    other = np.zeros(v.size)
    lengthened(M, v, load, limit, start, 0, T)
    lengthened(M, v, load, limit, start, ROUNDS // 2, other)
    take_shorter(v, other, T)
    helped = np.zeros(v.size)
    for i in range(v.size):
        helped[i] = T[i]
    relieved(M, v, load, limit, start, helped)
    take_shorter(v, helped, T)


@kernel
def take_shorter(v: Array, other: Array, T: Array) -> None:
    """Take other times over into `T` (nv,) if the joint that moves farthest then moves less."""
    way, other_way = 0.0, 0.0
    for i in range(v.size):
        way, other_way = max(way, abs(v[i] * T[i])), max(other_way, abs(v[i] * other[i]))
    if other_way < way:
        for i in range(v.size):
            T[i] = other[i]


@kernel
def relieved(M: Array, v: Array, load: Array, limit: Array, start: float, T: Array) -> None:
    """Shorten the farthest way of the times `T` (nv,), all of them at least `start`, if possible.

    Of a way `w` joint `i` asks a deceleration `d_i = |v_i| / T_i ≥ v_i² / (2 w)`; it may have more.
    Bisection finds the least `w` for which there are some within the torque limits.
    """
    n, most = v.size, max(start, LONGEST)
    d, lowest, asked = np.zeros(v.size), np.zeros(v.size), np.zeros(v.size)
    fastest, longest = 0.0, 0.0
    for i in range(n):
        fastest, longest = max(fastest, abs(v[i])), max(longest, 0.5 * abs(v[i]) * T[i])
    shortest = 0.5 * fastest * start
    for _ in range(HALVINGS):
        way = 0.5 * (shortest + longest)
        for i in range(n):
            size = abs(v[i])
            lowest[i] = min(max(size / most, 0.5 * size * size / max(way, 1e-9)), size / start)
            d[i] = lowest[i]
        if suffices(M, v, load, limit, start, lowest, d, asked):
            longest = way
            for i in range(n):
                T[i] = abs(v[i]) / max(d[i], 1e-9) if abs(v[i]) > 1e-9 else start
        else:
            shortest = way


@kernel
def suffices(
    M: Array,
    v: Array,
    load: Array,
    limit: Array,
    start: float,
    lowest: Array,
    d: Array,
    asked: Array,
) -> bool:
    """Raise decelerations `d` (nv,) above `lowest` until the torque suffices; whether it does.

    Joint by joint, each takes a step that lessens the sum of squares of what is beyond the limits,
    as shares of these. `asked` (nv,) is room for the torques.
    """
    n = v.size
    for i in range(n):
        asked[i] = load[i]
        for j in range(n):
            asked[i] -= PEAK * M[i, j] * math.copysign(d[j], v[j])
    for _ in range(SWEEPS):
        worst = 0.0
        for i in range(n):
            worst = max(worst, abs(asked[i]) / (SHARE * limit[i]) - 1.0)
        if worst <= SETTLED:
            return True
        for j in range(n):
            slope, bend = 0.0, 0.0
            for i in range(n):
                size = SHARE * limit[i]
                beyond = asked[i] - min(max(asked[i], -size), size)
                if beyond != 0.0:
                    per = -PEAK * M[i, j] * math.copysign(1.0, v[j]) / size
                    slope += per * beyond / size
                    bend += per * per
            if bend > 0.0:
                step = min(max(d[j] - slope / bend, lowest[j]), abs(v[j]) / start) - d[j]
                d[j] += step
                for i in range(n):
                    asked[i] -= PEAK * M[i, j] * math.copysign(1.0, v[j]) * step
    return False


@kernel
def lengthened(
    M: Array, v: Array, load: Array, limit: Array, start: float, rounds_apart: int, T: Array
) -> None:
    """Lengthen the joints' times from `start` until the torque suffices.

    In the first rounds those of the weak joints only, then all.
    """
    n, most = v.size, max(start, LONGEST)
    weak = np.zeros(v.size)
    for i in range(n):
        T[i] = start
    for k in range(ROUNDS):
        worst = 0.0
        for i in range(n):
            asked = load[i]
            for j in range(n):
                asked -= PEAK * M[i, j] * v[j] / T[j]
            weak[i] = abs(asked) - SHARE * limit[i]
            worst = max(worst, weak[i])
        if not worst > 0.0:
            break
        for i in range(n):
            if weak[i] > 0.0 or k >= rounds_apart:
                T[i] = min(LONGER * T[i], most)


@kernel
def on_path(
    t: float, v0: Array, a0: Array, T: Array, way: Array, speed: Array, rate: Array
) -> None:
    """Write way, speed and acceleration (nv,) of the braking path at the time `t`.

    Args:
        t: time since its start [s].
        v0: velocity at the start (nv,).
        a0: acceleration at the start (nv,).
        T: braking times (nv,) [s].
        way: from the configuration at the start (nv,), overwritten.
        speed: overwritten (nv,).
        rate: acceleration, overwritten (nv,).
    """
    r, w = RISE, min(t / EASING, 1.0)
    eased = w * w * (0.5 - w / 1.5 + 0.25 * w * w)
    for i in range(v0.size):
        u = min(t / T[i], 1.0)
        left = 1.0 - u
        if u < r:
            height, lost, gone = u / r, u * u / (2.0 * r), u * u * u / (6.0 * r)
        elif left < r:
            height, lost = left / r, 1.0 - r - left * left / (2.0 * r)
            gone = (1.0 - r) * (0.5 - left) + left * left * left / (6.0 * r)
        else:
            height, lost = 1.0, u - r / 2.0
            gone = r * r / 6.0 + r / 2.0 * (u - r) + (u - r) * (u - r) / 2.0
        # The trapezium, and the acceleration of the start as it fades.
        way[i] = v0[i] * T[i] * (u - gone / (1.0 - r)) + a0[i] * EASING * EASING * eased
        speed[i] = v0[i] * (1.0 - lost / (1.0 - r))
        speed[i] += a0[i] * EASING * w * (1.0 - w) * (1.0 - w)
        rate[i] = -v0[i] * height / ((1.0 - r) * T[i]) + a0[i] * (1.0 - w) * (1.0 - 3.0 * w)
