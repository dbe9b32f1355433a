"""`BrakingPath`: from any motion to rest, on the least way that the torque limits allow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.safety.braking_kernels import (
    FIRST,
    KEPT,
    LEARNT,
    RATE,
    ROWS,
    SPEED,
    UNKNOWN,
    WAY,
    advanced,
    drawn,
    is_faster,
    speed_left,
)
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

NAMES = ("start", "v", "a", "way", "unknown", "braking", "jerk", "first")
"""What the rows of the path's table are called where they are saved."""


class BrakingPath(SharesNothing):
    """The path on which a safe stop brakes, drawn as the arm goes.

    Where the torques suffice, all joints brake in the same time, such that the fastest one moves by
    0.2 rad or for 0.3 s. Where they do not, every tick seeks the least way `w` of the joint that
    moves farthest for which there are decelerations `d_i`,

        d_i ≥ v_i² / (2 (w - s_i)),   |h + u - 1.2 M (d ∘ sign v)| ≤ 0.95 τ_max,

    with `s` the ways so far: what the torques of Coriolis leave free as the arm slows down is used
    at once, and joints brake harder than they must where that relieves others. `u` is the torque
    that the model does not explain, as that of an unknown payload, learnt within 10 ms from the
    torque that acts. The acceleration of the path changes at a limited jerk, from that of the
    motion at first to none at rest.

    Attributes:
        least: least time in which a joint brakes, unless that relieves others [s].
        torque_rate: largest rates of the torques (nv,) [N·m/s, N/s]; they limit the jerk.
        bound: `w` [rad, m].
    """

    def __init__(self, arm: Arm, least: float, torque_rate: Array | None = None) -> None:
        """Make room for the path of an arm; `begin` begins it."""
        self._arm, self.least, self.bound = arm, least, 0.0
        self.torque_rate = np.full(arm.nv, np.inf) if torque_rate is None else torque_rate
        self._q, self._motion = np.zeros(arm.nq), np.zeros((ROWS, arm.nv))

    def begin(
        self,
        start: tuple[Array, Array, Array],
        M: Array,
        h: Array,
        unknown: Array,
        *,
        v: Array | None = None,
        is_urgent: bool = False,
    ) -> None:
        """Begin the path.

        Args:
            start: configuration (nq,), velocity (nv,) and acceleration (nv,) where it begins.
            M: mass matrix there (nv, nv).
            h: `C v + G` there (nv,).
            unknown: torque that the arm bears there beside `M a + h` (nv,).
            v: velocity of the arm there (nv,), where it is not the path's.
            is_urgent: whether the deceleration is to rise soon, also where torques suffice.
        """
        motion, limit = self._motion, self._arm.effort_limit
        self._q = np.array(start[0], dtype=np.float64)
        motion[SPEED], motion[RATE], motion[UNKNOWN] = start[1], start[2], unknown
        motion[FIRST] = np.abs(start[1] if v is None else v)
        self.bound = drawn(M, h, limit, self.torque_rate, self.least, is_urgent, motion)

    def advance(
        self, M: Array, h: Array, tau: Array, dt: float, *, learns: bool = True
    ) -> tuple[Array, Array, Array]:
        """Return `q` (nq,), `v` and `a` (nv,) after another `dt` seconds.

        Args:
            M: mass matrix where the arm is (nv, nv).
            h: `C v + G` there (nv,).
            tau: the torque that acted last (nv,).
            dt: the time [s].
            learns: whether `tau` is what moved the arm to where it was seen.
        """
        motion, weight = self._motion, min(LEARNT * dt, 1.0) if learns else 0.0
        limits = (self._arm.effort_limit, self.torque_rate)
        self.bound = advanced(M, h, tau, *limits, self.least, weight, dt, self.bound, motion)
        q = self._arm.integrate(self._q, motion[WAY])
        return q, motion[SPEED].copy(), motion[RATE].copy()

    @property
    def speed_left(self) -> float:
        """Which share the path leaves of a torque that grows with the square of the speeds."""
        return speed_left(self._motion)

    def is_faster(self, v: Array) -> bool:
        """Return whether a joint at the velocity `v` (nv,) is faster than at the beginning."""
        return is_faster(v, self._motion)

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        rows = dict(zip(NAMES, self._motion[:KEPT], strict=True))
        return {"q": self._q, "bound": np.array(self.bound)} | rows

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        arm = self._arm
        q = checks.finite_vector("q", present(arrays, "q"), arm.nq)
        bound = checks.finite_number("bound", present(arrays, "bound"), at_least=0.0)
        rows = [checks.finite_vector(name, present(arrays, name), arm.nv) for name in NAMES]
        self._q, self.bound = q, bound
        self._motion[:KEPT] = rows
