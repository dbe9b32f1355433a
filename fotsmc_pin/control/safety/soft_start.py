"""A reference that begins where the arm is, at the speed that it has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.safety.steps import faded
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
        if self._t >= self.duration:
            return q_d, v_d, a_d
        e, e_dot = self._offset
        way, v_led, a_led = np.empty_like(e), np.array(v_d, float), np.array(a_d, float)
        faded(self._t, self.duration, e, e_dot, v_led, a_led, way)
        return self.arm.integrate(q_d, way), v_led, a_led


class Unled:
    """In the place of a `SoftStart`: what is followed is the reference itself."""

    duration = 0.0

    def reset(self) -> None:
        """Do nothing."""

    def save_state(self) -> dict[str, Array]:
        """Return nothing."""
        return {}

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take nothing."""

    def lead(self, q: Any, v: Any, q_d: Any, v_d: Any, a_d: Any, dt: float) -> tuple[Any, Any, Any]:
        """Return the reference as it is."""
        return q_d, v_d, a_d
