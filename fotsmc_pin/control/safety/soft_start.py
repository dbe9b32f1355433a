"""A reference that begins where the arm is, at the speed that it has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class SoftStart(SharesNothing):
    """Leads from any state into a reference within `duration` seconds.

    The offset of the first measurement, `e(0)` and `ė(0)`, is faded out by quintics, so that the
    reference that the controller sees begins without position and speed error and with the
    acceleration of the original one:

        q_d ⊕ (e(0) p(u) + ė(0) T r(u)),   u = t / T
        p = 1 - 10 u³ + 15 u⁴ - 6 u⁵,   r = u - 6 u³ + 8 u⁴ - 3 u⁵

    Args:
        arm: the arm.
        duration: `T` [s]; 0 leaves the reference as it is.

    Raises:
        ArgumentError: a negative duration.
    """

    def __init__(self, arm: Arm, duration: float) -> None:
        self.arm = arm
        self.duration = checks.finite_number("duration", duration, at_least=0.0)
        self.reset()

    def reset(self) -> None:
        """Begin anew: the next state is the first."""
        self._t = 0.0
        self._offset: tuple[Array, Array] | None = None

    def save_state(self) -> dict[str, Array]:
        """Return the time since the start and the offset, empty before the first state."""
        offset = np.zeros((0, self.arm.nv)) if self._offset is None else np.array(self._offset)
        return {"t": np.array(self._t), "offset": offset}

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        t = checks.finite_number("t", present(arrays, "t"), at_least=0.0)
        given = present(arrays, "offset")
        rows = 2 if np.size(given) else 0
        offset = checks.finite_array("offset", given, (rows, self.arm.nv))
        self._t, self._offset = t, (offset[0], offset[1]) if rows else None

    def lead(
        self, q: Array, v: Array, q_d: Array, v_d: Array, a_d: Array, dt: float
    ) -> tuple[Array, Array, Array]:
        """Return what to follow at this tick in place of `q_d`, `v_d`, `a_d`.

        Args:
            q: measured configuration (nq,).
            v: measured velocity (nv,).
            q_d: reference configuration (nq,).
            v_d: reference velocity (nv,).
            a_d: reference acceleration (nv,).
            dt: time since the last tick [s]; not used at the first.
        """
        if self._offset is None:
            self._offset = self.arm.difference(q_d, q), np.subtract(v, v_d)
        else:
            self._t += dt
        T = self.duration
        if self._t >= T:
            return q_d, v_d, a_d
        u = self._t / T
        e, e_dot = self._offset
        e_dot = T * e_dot
        p = 1.0 - u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
        r = u - u**3 * (6.0 - 8.0 * u + 3.0 * u * u)
        p_dot = -30.0 * u * u * (1.0 - u) ** 2
        r_dot = 1.0 - u * u * (18.0 - 32.0 * u + 15.0 * u * u)
        p_ddot = -60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
        r_ddot = -u * (36.0 - 96.0 * u + 60.0 * u * u)
        return (
            self.arm.integrate(q_d, e * p + e_dot * r),
            v_d + (e * p_dot + e_dot * r_dot) / T,
            a_d + (e * p_ddot + e_dot * r_ddot) / T**2,
        )
