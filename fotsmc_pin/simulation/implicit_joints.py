"""`ImplicitJoints`: what the kernels need of an arm with friction and springs in its joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms.perturbation import demand_motors
from fotsmc_pin.simulation import dry_friction as rows

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class ImplicitJoints:
    """The joints' constants and state, and the arm's terms, for steps that `slide` takes.

    An elastic joint has its rotor, the arm's armature, behind the spring and not in `M`. At the
    start the spring carries gravity and the motor turns with the link.

    Attributes:
        is_elastic: whether any joint has a spring.
        model: Pinocchio's model without the rotors of elastic joints.
        data: its scratch memory.
        mass: `M` (nv, nv), as `crba` leaves it in `data`.
        bias: `C v + G` (nv,), as `nonLinearEffects` does.
        deflection: `θ - q`, motor beyond link, (nv,) [rad, m]; own memory.
        motor_speed: of the motors, (nv,) [rad/s, m/s]; own memory.
    """

    def __init__(self, arm: Arm, q: Array, v: Array, table: Array) -> None:
        """Start at the configuration `q` and the speed `v`, with a table of zeros to fill."""
        demand_motors(arm)
        elastic = np.isfinite(arm.joint_stiffness)
        self.is_elastic = bool(elastic.any())
        self.model = arm.model
        if self.is_elastic:
            self.model = arm.model.copy()
            self.model.armature = np.where(elastic, 0.0, arm.armature)
        self.data = self.model.createData()
        table[rows.DAMPING], table[rows.FRICTION] = arm.damping, arm.friction
        table[rows.STICTION], table[rows.STRIBECK] = arm.stiction, arm.stribeck_velocity
        table[rows.ROTOR], table[rows.SPRING_DAMPING] = arm.armature, arm.joint_damping
        table[rows.STIFFNESS] = np.where(elastic, arm.joint_stiffness, 0.0)
        self.deflection, self.motor_speed = table[rows.DEFLECTION], table[rows.MOTOR_SPEED]
        self.deflection[elastic] = arm.gravity(q)[elastic] / arm.joint_stiffness[elastic]
        self.motor_speed[:] = v
        table[rows.SLIDES] = np.sign(v)
        # M is symmetric: the transpose is the same in the order that kernels read best.
        self.mass, self.bias = self.data.M.T, self.data.nle
