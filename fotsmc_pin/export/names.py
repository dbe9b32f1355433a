"""How the parts of a program are called, and what a caller is told of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.export.dialect import file_identifier

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

INIT = "Fill in the gains as they were exported, and begin anew. Call it before all else."
RESET = "Forget everything but the gains: the next tick is the first."
UPDATE = (
    "Advance by one tick.",
    "",
    "  q, v           measured configuration and velocity",
    "  q_d, v_d, a_d  reference: configuration, velocity, acceleration",
    "  M              mass matrix at q, all of it, row by row (Pinocchio's crba)",
    "  h              C v + g at q and v (Pinocchio's nonLinearEffects)",
)
TAU = (
    "  dt             measured time since the last tick, or @_DT",
    "  tau            the torque, written: finite, within the effort limits",
)
FRICTION = (
    "The friction of this arm is known, and is part of the law's model: h = C v + g + F(v_d) with",
    "F = D v_d + (F_c + (F_s - F_c) exp(-(v_d / v_s)^2)) tanh(v_d / 0.002), from the arm's URDF.",
)
ERRORS = (
    "Returns @_OK. Any other status leaves the state as it was, and writes the torque",
    "of the last tick; the next good tick goes on from there.",
)


STOPS = (
    ("STOPPED", "a safe stop was asked for"),
    ("TOO_LATE", "a tick came later than the watchdog allows"),
    ("TOO_FAST", "a joint was faster than it may be"),
)
"""Why a safe stop is on, beside the status codes of the law."""

GUARDED_INIT = (
    "Fill in gains and limits as they were exported, and begin anew. Call it before all else."
)
GUARDED_RESET = "End a stop and forget everything but gains and limits: the next tick is the first."
STOP = "Begin a safe stop; the next tick is its first."
GRAVITY = "  g              gravity at q (Pinocchio's computeGeneralizedGravity)"
RESULT = (
    "Returns @_OK while all is well. Any other status tells why a safe stop is on: the arm",
    "is braked and then held. Only a reset ends it.",
    "",
    "tau is the total torque. What of it is to be commanded, without what the drives add of",
    "their own accord, is state->sent.",
)


@dataclass(frozen=True)
class Names:
    """How the parts of a program are called.

    Attributes:
        prefix: what all public names begin with.
        state: type of the law's state.
        functions: what the names of the law's own functions begin with.
        scope: what stands before them, "static " where a wrapper calls them.
    """

    prefix: str
    state: str
    functions: str
    scope: str = ""

    @classmethod
    def of(cls, arm: Arm, *, wrapped: bool) -> Names:
        """Return the names for an arm."""
        prefix = f"fotsmc_{file_identifier(arm.name)}"
        if wrapped:
            return cls(prefix, f"{prefix}_law", "law", "static ")
        return cls(prefix, f"{prefix}_state", prefix)

    def status(self, name: str) -> str:
        """Return a status code."""
        return f"{self.prefix.upper()}_{name}"
