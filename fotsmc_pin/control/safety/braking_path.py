"""`BrakingPath`: from any motion to rest, as fast as the torque limits allow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

SHARE = 0.8
"""Share of the effort limits that braking may take; the rest is for what the model lacks."""
LONGEST = 0.5
"""The slowest braking, for an arm that is too weak to hold itself while it brakes [s]."""
EASING = 0.02
"""Time in which the acceleration at the start is faded out [s]."""


class BrakingPath:
    """The path on which a safe stop brakes: all joints come to rest together.

        v(t) = v0 (1 - 3 u² + 2 u³) + a0 T_a (w - 2 w² + w³),   u = t / T, w = t / T_a

    Speed and acceleration have no step, neither at the start nor at the end. `T` is the shortest
    time in which the largest deceleration, `1.5 v0 / T`, asks for at most 0.8 of the effort limits;
    `T_a` is 20 ms.

    Args:
        arm: the nominal arm.
        q: configuration at the start (nq,).
        v: velocity at the start (nv,).
        a: acceleration at the start (nv,).
        shortest: least `T` [s].
    """

    def __init__(self, arm: Arm, q: Array, v: Array, a: Array, shortest: float) -> None:
        self._arm, self._q, self._v, self._a, self._t = arm, q, v, a, 0.0
        self.duration = braking_time(arm, q, v, shortest)

    def advance(self, dt: float) -> tuple[Array, Array, Array]:
        """Return `q` (nq,), `v` and `a` (nv,) after another `dt` seconds."""
        self._t += dt
        T, Ta = max(self.duration, 1e-9), EASING
        u, w = min(self._t / T, 1.0), min(self._t / Ta, 1.0)
        way = self._v * T * (u - u**3 + 0.5 * u**4)
        way += self._a * Ta**2 * (0.5 * w**2 - w**3 / 1.5 + 0.25 * w**4)
        speed = self._v * (1.0 - u * u * (3.0 - 2.0 * u)) + self._a * Ta * w * (1.0 - w) ** 2
        rate = self._v * (6.0 * u * (u - 1.0) / T) + self._a * (1.0 - w) * (1.0 - 3.0 * w)
        return self._arm.integrate(self._q, way), speed, rate

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        return {
            "q": self._q,
            "v": self._v,
            "a": self._a,
            "t": np.array([self._t, self.duration]),
        }

    @classmethod
    def restored(cls, arm: Arm, arrays: Mapping[str, Array]) -> BrakingPath:
        """Return the path that `save_state` told of."""
        path = cls(arm, arrays["q"], arrays["v"], arrays["a"], 1.0)
        path._t, path.duration = arrays["t"].tolist()
        return path


def braking_time(arm: Arm, q: Array, v: Array, shortest: float) -> float:
    """Return the time in which the arm can brake from `v` (nv,) at `q` (nq,) [s]."""
    if shortest == 0.0:
        return 0.0
    asked = -1.5 * (arm.mass_matrix(q) @ v)  # over T it is the torque of the hardest moment
    weight = arm.gravity(q)
    room = SHARE * arm.effort_limit - np.sign(asked) * weight
    slowest = max(shortest, LONGEST)
    needed = [
        abs(ask) / left if left > 0.0 else slowest
        for ask, left in zip(asked.tolist(), room.tolist(), strict=True)
        if ask
    ]
    return float(min(max([shortest, *needed]), slowest))
