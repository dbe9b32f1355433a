"""`FrictionTerms`: a model's terms with the friction that the wanted speed will meet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.control.model_terms import ModelTerms

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array

WIDTH = 2e-3
"""Speed over which Coulomb friction changes sign [rad/s, m/s]; a wider one spoils reversals."""


class FrictionTerms(ModelTerms):
    """`M0` and `h0 = C0 v + G0 + F(v_d)`, with the friction of the arm's file fed forward.

        F(v_d) = D v_d + (F_c + (F_s - F_c) exp(-(v_d / v_s)²)) tanh(v_d / width)

    As it stands in `h0`, a law's torque limits, memories and observers know of it, which they do
    not of a torque that is added outside (`FrictionCompensation`). The speed is the desired one, so
    that no loop is closed. Give it to a law that knows its friction, such as that of an
    identified arm: `controller.use_terms(FrictionTerms(result.arm))`.

    Args:
        arm: the nominal arm, whose viscous, Coulomb and breakaway friction is taken.
    """

    def __init__(self, arm: Arm) -> None:
        demand_arm(arm)
        super().__init__(arm.model)
        self._damping, self._friction = arm.damping, arm.friction
        self._more, self._fall = arm.friction * (arm.stiction - 1.0), arm.stribeck_velocity

    def evaluate(self, q: Array, joints: Joints) -> None:
        """Write the terms at the configuration `q` (nq,) and the velocities of `joints`."""
        super().evaluate(q, joints)
        v_d = joints.v_d
        dry = self._friction + self._more * np.exp(-((v_d / self._fall) ** 2))
        self.h += self._damping * v_d + dry * np.tanh(v_d / WIDTH)
