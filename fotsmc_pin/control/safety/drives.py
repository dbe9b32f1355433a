"""`Drives`: what a robot's own drives add to the torque that they are commanded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.controller import Controller
from fotsmc_pin.control.friction_terms import FrictionTerms
from fotsmc_pin.control.model_terms import ModelTerms
from fotsmc_pin.control.safety.seen import Seen
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

COMPENSABLE = ("gravity", "coriolis", "friction")
"""What drives may add of their own accord."""


class Drives:
    """The torque between what is commanded and what acts at the joints.

    Everything in this library is the total torque `τ` of `M a + C v + G = τ`, friction apart. Many
    robots compensate a part of it themselves, so that they must be sent

        τ_sent = τ - G0(q)            where they add gravity,
        τ_sent = τ - C0(q, v) v       where they add Coriolis and centrifugal torque.

    Drives that compensate friction hide it: what acts on the links is `τ` as if there were none,
    so nothing is subtracted, and no friction compensation may be added.

    Args:
        arm: the nominal arm, in place of the model that is inside of the robot.
        compensates: what the drives add: any of "gravity", "coriolis", "friction".

    Raises:
        ArgumentError: a word that is none of these.
    """

    def __init__(self, arm: Arm, compensates: tuple[str, ...] = ()) -> None:
        if isinstance(compensates, str):
            raise ArgumentError(
                "compensates", compensates, f"give a tuple, as in ({compensates!r},)"
            )
        self._arm = arm
        self.compensates = tuple(
            checks.choice("compensates", word, COMPENSABLE) for word in compensates
        )

    @property
    def adds(self) -> bool:
        """Whether what is sent differs from the total torque."""
        return "gravity" in self.compensates or "coriolis" in self.compensates

    @property
    def hides_friction(self) -> bool:
        """Whether the drives compensate friction."""
        return "friction" in self.compensates

    def tell(self, controller: Any) -> None:
        """Let a law whose model knows friction leave that to the drives, or take it up again."""
        while not isinstance(controller, Controller):
            controller = getattr(controller, "controller", None)
            if controller is None:
                return
        known = isinstance(controller.model_terms, FrictionTerms)
        if known and self.hides_friction:
            controller.use_terms(ModelTerms(self._arm.model))
        elif controller.arm.friction_is_known and type(controller.model_terms) is ModelTerms:
            controller.use_terms(FrictionTerms(controller.arm))

    def added(self, q: Array | None, v: Array) -> Array:
        """Return the torque (nv,) that the drives add at `q` (nq,) and `v` (nv,).

        Nothing where `q` is None, as before anything was measured.
        """
        if q is None or not self.adds:
            return np.zeros(self._arm.nv)
        seen = Seen(self._arm)
        seen.see(q, v)
        return self.added_at(seen)

    def added_at(self, seen: Seen) -> Array:
        """Return the torque (nv,) that the drives add where the arm was seen."""
        if seen.q is None or not self.adds:
            return np.zeros(self._arm.nv)
        if "coriolis" not in self.compensates:
            return seen.gravity
        return seen.h if "gravity" in self.compensates else seen.h - seen.gravity
