"""`ModelTerms`: what a law knows of the arm, evaluated once a tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pinocchio as pin

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array


class ModelTerms:
    """The mass matrix `M0` and `h0 = C0 v + G0` of a Pinocchio model.

    A wrapper may give a controller other terms (`Controller.use_terms`), such as those of a model
    that is learnt; the law works with them as with its own.

    Attributes:
        model: the model.
        M: live view of the mass matrix (nv, nv). It is symmetric, so that its transpose, which
            lies in memory row by row, is itself.
        h: live view of `C0 v + G0` (nv,).
    """

    def __init__(self, model: pin.Model) -> None:
        self.model, self._data = model, model.createData()
        self.M: Array = self._data.M.T
        self.h: Array = self._data.nle

    def is_bare(self, arm: Arm) -> bool:
        """Return whether these are the terms of an arm alone, nothing learnt and no friction."""
        return type(self) is ModelTerms and self.model is arm.model

    def evaluate(self, q: Array, joints: Joints) -> None:
        """Write the terms at the configuration `q` (nq,) and the velocity of `joints`."""
        pin.crba(self.model, self._data, q)
        pin.nonLinearEffects(self.model, self._data, q, joints.v)
