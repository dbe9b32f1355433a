"""Friction torque ahead of time, from the speed that is asked for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

WIDTH = 0.02
"""Speed over which the Coulomb part changes sign [rad/s, m/s]."""


class FrictionCompensation:
    """`τ_f = F tanh(v_d / width) + D v_d`, to be added to a controller's torque.

    It looks at the desired speed and not at the measured one, so it closes no loop and cannot
    make one unstable, even where the friction is overestimated.

    Args:
        arm: the nominal arm.
        friction: Coulomb friction `F`, one number or one per joint [N·m, N]; the arm's own if None.
        damping: viscous friction `D` [N·m·s/rad, N·s/m]; the arm's own if None.
        width: speed over which the Coulomb part changes sign [rad/s, m/s].

    Raises:
        ArgumentError: a negative friction, or a width that is not above 0.
    """

    def __init__(
        self,
        arm: Arm,
        *,
        friction: ArrayLike | None = None,
        damping: ArrayLike | None = None,
        width: float = WIDTH,
    ) -> None:
        self.friction = checks.per_joint(
            "friction", arm.friction if friction is None else friction, arm.nv, at_least=0.0
        )
        self.damping = checks.per_joint(
            "damping", arm.damping if damping is None else damping, arm.nv, at_least=0.0
        )
        self.width = checks.finite_number("width", width, above=0.0)

    def torque(self, v_d: ArrayLike) -> Array:
        """Return the torque (nv,) that friction will ask for at the desired speed (nv,)."""
        speed = np.array(v_d, dtype=np.float64)
        torque = np.zeros(speed.size)
        add_friction(speed, self.friction, self.damping, self.width, torque)
        return torque


@kernel
def add_friction(v_d: Array, friction: Array, damping: Array, width: float, tau: Array) -> None:
    """Add `F tanh(v_d / width) + D v_d`, which friction will ask for, to the torque `tau` (nv,)."""
    for i in range(tau.size):
        tau[i] += friction[i] * math.tanh(v_d[i] / width) + damping[i] * v_d[i]
