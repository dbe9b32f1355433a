"""`BrakingPath`: from any motion to rest, as fast as the torque limits allow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

SHARE = 0.92
"""Share of the effort limits that braking may take; the rest is for what the model lacks."""
LONGEST = 0.5
"""The slowest braking, for an arm that is too weak to hold itself while it brakes [s]."""
RISE = 0.15
"""Share of the braking time in which the deceleration rises, and in which it falls."""
ROOM, GENTLE = 0.2, 0.2
"""The way that a stop may well take [rad, m], and the time [s]: it is not harder than that."""
EASING = 0.02
"""Time in which the acceleration at the start is faded out [s]."""
LONGER, ROUNDS = 1.05, 60
"""Factor and number of the steps in which the times are lengthened."""


class BrakingPath:
    """The path on which a safe stop brakes.

    The deceleration of a joint rises, stays and falls, a trapezium over its time `T`, of height
    `v0 / (0.85 T)`. Each joint has the shortest time with which the torques asked for are within
    0.92 of the effort limits, or all have one, whichever moves them less. The acceleration at
    the start, which is the motion's, is faded out over 20 ms, so that speed and acceleration have
    no step.

    Args:
        arm: the nominal arm.
        q: configuration at the start (nq,).
        v: velocity at the start (nv,).
        a: acceleration at the start (nv,).
        load: torque that the arm bears at the start beyond its inertia (nv,).
        shortest: least `T` [s].
    """

    def __init__(
        self, arm: Arm, q: Array, v: Array, a: Array, load: Array, shortest: float
    ) -> None:
        self._arm, self._q, self._v, self._a, self._t = arm, q, v, a, 0.0
        self.duration = braking_times(arm, q, v, load, shortest)

    def advance(self, dt: float) -> tuple[Array, Array, Array]:
        """Return `q` (nq,), `v` and `a` (nv,) after another `dt` seconds."""
        self._t += dt
        T, Ta = self.duration, EASING
        u, w = np.minimum(self._t / T, 1.0), min(self._t / Ta, 1.0)
        a, v, q = _trapezium(u)
        way = self._v * T * q + self._a * Ta**2 * (0.5 * w**2 - w**3 / 1.5 + 0.25 * w**4)
        speed = self._v * v + self._a * Ta * w * (1.0 - w) ** 2
        rate = self._v * a / T + self._a * (1.0 - w) * (1.0 - 3.0 * w)
        return self._arm.integrate(self._q, way), speed, rate

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        return {
            "q": self._q,
            "v": self._v,
            "a": self._a,
            "t": np.array(self._t),
            "duration": self.duration,
        }

    @classmethod
    def restored(cls, arm: Arm, arrays: Mapping[str, Array]) -> BrakingPath:
        """Return the path that `save_state` told of."""
        q, v, a, duration = (np.array(arrays[name]) for name in ("q", "v", "a", "duration"))
        path = cls(arm, q, v, a, a, 1.0)
        path._t, path.duration = float(arrays["t"]), duration
        return path


def braking_times(arm: Arm, q: Array, v: Array, load: Array, shortest: float) -> Array:
    """Return the time in which each joint can brake from `v` at `q` (nv,) [s].

    A joint whose torque does not suffice is given longer; where that does not help, as the others'
    braking asks it of the joint, all are.
    """
    fastest = float(np.abs(v).max(initial=0.0))
    gentle = 2.0 * ROOM / max(fastest, 1e-9)
    start = min(max(shortest, gentle), max(shortest, GENTLE))
    asked, limit = arm.mass_matrix(q) / (1.0 - RISE), SHARE * arm.effort_limit
    together, alone = (
        feasible_times(asked, v, load, limit, start, apart=apart) for apart in (False, True)
    )
    return min(together, alone, key=lambda T: float(np.abs(v * T).max(initial=0.0)))


def feasible_times(
    asked: Array, v: Array, load: Array, limit: Array, start: float, *, apart: bool
) -> Array:
    """Lengthen the joints' times from `start` until the torque suffices, of all or `apart`."""
    T, most = np.full(len(v), start), max(start, LONGEST)
    for k in range(ROUNDS):
        weak = np.abs(load - asked @ (v / T)) > limit
        if not weak.any():
            break
        longer = weak if apart and k < ROUNDS // 2 else weak.any()
        T = np.where(longer, np.minimum(LONGER * T, most), T)
    return T


def _trapezium(u: Array) -> tuple[Array, Array, Array]:
    """Return acceleration, speed and way (n,) at the share `u` (n,) of the time, from speed 1."""
    r, left = RISE, 1.0 - u
    rising, falling = u < r, left < r
    a = np.where(rising, u / r, np.where(falling, left / r, 1.0))
    lost = np.where(rising, u**2 / (2 * r), np.where(falling, 1 - r - left**2 / (2 * r), u - r / 2))
    middle = r**2 / 6 + r / 2 * (u - r) + (u - r) ** 2 / 2
    late = (1 - r) * (0.5 - left) + left**3 / (6 * r)
    way = np.where(rising, u**3 / (6 * r), np.where(falling, late, middle))
    return -a / (1 - r), 1.0 - lost / (1 - r), u - way / (1 - r)
