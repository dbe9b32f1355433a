"""`Carried`: a mass at the tool that the nominal arm lacks, found from what its motion asked."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.safety.brake import unexplained
from fotsmc_pin.control.safety.steps import BORNE, RECENT, SPEED
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.safety.seen import Seen
    from fotsmc_pin.types import Array

USUAL = 0.15
"""Standard deviation of the mass over that of the moving links."""
FRICTION, FULL_EFFORT = 0.5, 20.0
"""Standard deviation of what else a joint bears [N·m, N], from this effort limit on; of a weaker
one in proportion less."""
SHARE = 0.02
"""The same as a share of the drive, where that is more: friction, and errors of the links."""


class Carried(SharesNothing):
    """A point mass `m` at the tool, which a safe stop takes into its model.

    It is the mean of what is to be expected of `m` after the torque `w` beyond the nominal arm's,

        m = Σ φ_i w_i / σ_i² / (Σ φ_i² / σ_i² + 1 / σ_m²),   φ = M_1 a + h_1,

    where `M_1` and `h_1 = C_1 v + G_1` are those of one kilogram at the tool of a weightless arm.

    Attributes:
        mass: `m` [kg]; 0 until it is found.
    """

    linked: ClassVar[frozenset[str]] = frozenset({"_model", "_data"})

    def __init__(self, arm: Arm) -> None:
        """Make an arm whose tool alone weighs something."""
        self.arm = arm
        masses = sum(float(inertia.mass) for inertia in [*arm.model.inertias][1:])
        size = drive_size(arm)
        other = np.maximum(FRICTION * np.minimum(1.0, size / FULL_EFFORT), SHARE * size)
        self._weight, self._least_weight = other**-2.0, (USUAL * masses) ** -2.0
        self._link()
        self.reset()

    def _link(self) -> None:
        self._model = model = pin.Model(self.arm.model)
        for j in range(1, model.njoints):
            model.inertias[j] = pin.Inertia.Zero()
        tool = model.frames[self.arm.tool_frame_id]
        ball = pin.Inertia(1.0, tool.placement.translation, np.zeros((3, 3)))
        model.inertias[tool.parentJoint] = ball
        model.armature = np.zeros(model.nv)
        self._data = model.createData()

    def reset(self) -> None:
        """Carry nothing."""
        self.mass = 0.0

    def find(self, seen: Seen, recent: Array) -> None:
        """Find the mass from the torque that the nominal arm does not explain.

        Args:
            seen: where the arm is.
            recent: averages of what acted and of what was seen (4, nv); see `steps.averaged`.
        """
        M, h = self._unit(seen)
        w = np.zeros(self.arm.nv)
        unexplained(seen.v, recent, seen.mass_matrix, w)
        a = RECENT * (seen.v - recent[SPEED])
        self.mass = mass_found(M, h, a, w, self._weight, self._least_weight)

    def model(self, seen: Seen, recent: Array) -> tuple[Array, Array, Array]:
        """Return mass matrix, `C v + G` and averages of the arm that carries the mass.

        Args:
            seen: where the arm is.
            recent: the averages of the nominal arm (4, nv).
        """
        if self.mass == 0.0:
            return seen.mass_matrix, seen.h, recent
        M, h = self._unit(seen)
        beyond = recent.copy()
        beyond[BORNE] -= self.mass * h
        return seen.mass_matrix + self.mass * M, seen.h + self.mass * h, beyond

    def _unit(self, seen: Seen) -> tuple[Array, Array]:
        """Return `M_1` and `h_1`, of the speed only so much as `seen` has of it."""
        model, data = self._model, self._data
        M = np.ascontiguousarray(pin.crba(model, data, seen.q).T)
        weight = pin.computeGeneralizedGravity(model, data, seen.q).copy()
        turning = pin.nonLinearEffects(model, data, seen.q, seen.v) - weight
        return M, weight + (seen.share * turning if seen.is_believed else 0.0)

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        return {"mass": np.array(self.mass)}

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        self.mass = checks.finite_number("mass", present(arrays, "mass"), at_least=0.0)


@kernel
def mass_found(
    unit_M: Array, unit_h: Array, a: Array, w: Array, weight: Array, least_weight: float
) -> float:
    """Return the mass of `Carried`."""
    above, below = 0.0, least_weight
    for i in range(a.size):
        share = unit_h[i]
        for j in range(a.size):
            share += unit_M[i, j] * a[j]
        above += weight[i] * share * w[i]
        below += weight[i] * share * share
    return float(max(above / below, 0.0))
