"""`AccelerationLaw`: the frame of laws that command an acceleration, with an integral at most."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.control.controller import Controller
from fotsmc_pin.control.switching import SWITCHING

if TYPE_CHECKING:
    from fotsmc_pin.control.gains import Array


class AccelerationLaw(Controller):
    """Frame of the laws `τ = M0 a + C0 v + G0`, with `a` a function of the errors and an integral.

    Such a law is its `Gains`, a kernel of one tick, and

        @property
        def _kernel(self) -> Kernel:
            return control_law

    The kernel's arguments after `dt` are, in this order,

    - `joints` (7, nv): rows `E`, `ED`, `V`, `V_D`, `A_D`, `TAU`, `LIMIT`; the torque is written;
    - `M0` (nv, nv), `h0` (nv,): for `saturation.inverse_dynamics`;
    - `gains`: the numbers of `Gains` in the order of its fields, a row each and a column per joint;
    - `kind`: code of the switching function that the gains name, for `switching.switch`;
    - `z` (nv,): an integral, zero at the start; it is the law's only memory;
    - `work` (3, nv): `s`, which is shown as the signal "s", `a` and `excess`.
    """

    def _prepare(self) -> None:
        n = self.arm.nv
        self._state = np.zeros(n)
        work = np.zeros((3, n))
        self._signals: dict[str, Array] = {"s": work[0]}
        self._arguments: tuple[Any, ...] = (
            self._joints,
            self._M0,
            self._h0,
            self._pack(*self.gains.numbers()),
            SWITCHING.index(getattr(self.gains, "switching", "sign")),
            self._state,
            work,
        )
