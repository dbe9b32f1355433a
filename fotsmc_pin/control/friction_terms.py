"""`FrictionTerms`: a model's terms with the friction that the wanted speed will meet."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.compiled import kernel
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
    that no loop is closed. Every law that uses a model has these terms where the friction of its
    arm is known (`Arm.friction_is_known`).

    Args:
        arm: the nominal arm, whose viscous, Coulomb and breakaway friction is taken.
    """

    def __init__(self, arm: Arm) -> None:
        demand_arm(arm)
        super().__init__(arm.model)
        more = arm.friction * (arm.stiction - 1.0)
        numbers = arm.damping, arm.friction, more, arm.stribeck_velocity
        self._numbers = np.array(numbers)

    def evaluate(self, q: Array, joints: Joints) -> None:
        """Write the terms at the configuration `q` (nq,) and the velocities of `joints`."""
        super().evaluate(q, joints)
        add_friction(joints.v_d, self._numbers, self.h)


@kernel
def add_friction(v_d: Array, numbers: Array, h: Array) -> None:
    """Add `F(v_d)` to `h` (nv,); the rows of `numbers` are `D`, `F_c`, `F_s - F_c` and `v_s`."""
    damping, friction, more, fall = numbers
    for j in range(v_d.size):
        dry = friction[j] + more[j] * math.exp(-((v_d[j] / fall[j]) ** 2))
        h[j] += damping[j] * v_d[j] + dry * math.tanh(v_d[j] / WIDTH)


def terms_of(arm: Arm, *, feeds_friction: bool) -> ModelTerms:
    """Return an arm's own terms, with its friction where that is known and is to be fed."""
    feeds = feeds_friction and arm.friction_is_known
    return FrictionTerms(arm) if feeds else ModelTerms(arm.model)


def are_own(terms: ModelTerms) -> bool:
    """Return whether terms are those of an arm, and not of what wraps its law."""
    return type(terms) in (ModelTerms, FrictionTerms)
