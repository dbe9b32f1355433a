"""`ImplicitJoints`: what the kernels need of an arm with friction and springs in its joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.simulation import dry_friction as rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm

    Array = NDArray[np.float64]

LOCAL = pin.Convention.LOCAL
"""Faster than the default for a mass matrix alone, and the same to rounding."""


class ImplicitJoints:
    """The joints' constants and state, and the arm's terms, for steps that `slide` takes.

    An elastic joint has its rotor, the arm's armature, behind the spring and not in `M`. At the
    start the spring carries gravity and the motor turns with the link.

    Attributes:
        is_elastic: whether any joint has a spring.
        mass: `M` (nv, nv), without the rotors of elastic joints.
        bias: `C v + G` (nv,).
        factor: room for a factorisation (nv, nv).
        table: rows of constants and state, as `dry_friction` names them.
        deflection: `θ - q`, motor beyond link, (nv,) [rad, m]; own memory.
        motor_speed: of the motors, (nv,) [rad/s, m/s]; own memory.
    """

    def __init__(self, arm: Arm, q: Array, v: Array) -> None:
        """Start at the configuration `q` and the speed `v`."""
        elastic = np.isfinite(arm.joint_stiffness)
        self.is_elastic = bool(elastic.any())
        self._model = arm.model
        if self.is_elastic:
            self._model = arm.model.copy()
            self._model.armature = np.where(elastic, 0.0, arm.armature)
        self._data = self._model.createData()
        self._table = table = np.zeros((rows.TABLE_ROWS, arm.nv))
        table[rows.DAMPING], table[rows.FRICTION] = arm.damping, arm.friction
        table[rows.STICTION], table[rows.STRIBECK] = arm.stiction, arm.stribeck_velocity
        table[rows.ROTOR], table[rows.SPRING_DAMPING] = arm.armature, arm.joint_damping
        table[rows.STIFFNESS] = np.where(elastic, arm.joint_stiffness, 0.0)
        self.deflection, self.motor_speed = table[rows.DEFLECTION], table[rows.MOTOR_SPEED]
        self.deflection[elastic] = arm.gravity(q)[elastic] / arm.joint_stiffness[elastic]
        self.motor_speed[:] = v
        table[rows.SLIDES] = np.sign(v)
        # M is symmetric: the transpose is the same in the order that kernels read best.
        self.mass, self.bias = self._data.M.T, self._data.nle
        self.factor, self.table = np.zeros((arm.nv, arm.nv)), table

    def update(self, q: Array, v: Array) -> None:
        """Compute `mass` and `bias` at a state."""
        pin.crba(self._model, self._data, q, LOCAL)
        pin.nonLinearEffects(self._model, self._data, q, v)
