"""`Limits`: what an arm may never pass, whatever a law says."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.control.safety.deceleration import available_braking
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

QUICKEST_START = 0.05
"""Time from rest to full speed by the acceleration limit that is not given [s]."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of an arm's motion that hold whatever a law says: `Safeguard(law, limits=...)`.

    A joint is never let so near to an end, at such a speed, that it could no longer brake before
    it. Speeds stay within their limits, the torque within the arm's. Where nothing is near its
    limit, the torque is that of the law, bit for bit; the signal "limit_torque" (nv,) is what was
    added to it. Where a limit cannot be kept, a safe stop begins. The first tick after a reset
    raises an `ArgumentError` for a state beyond the limits.

    Attributes:
        arm: the nominal arm.
        lower: lowest position of each joint (nv,) [rad, m]; None for the arm's.
        upper: highest position of each joint (nv,) [rad, m]; None for the arm's.
        margin: how far before an end a joint is held (nv,) [rad, m]: room for what the model does
            not know. A joint that starts nearer to its end is held where it started.
        velocity: largest speed of each joint (nv,) [rad/s, m/s]; None for the arm's.
        velocity_share: share of `velocity` at which a joint is held; room for what the model does
            not know.
        acceleration: largest acceleration and deceleration of each joint (nv,) [rad/s², m/s²], of
            the nominal arm; None for what leads from rest to full speed in 0.05 s.
        braking: deceleration that every joint is trusted to have (nv,) [rad/s², m/s²]; None for
            what `torque_share` of the torque limits gives all joints at once in 95 of 100 random
            states of the nominal arm, and no more than stops a joint from full speed in 0.1 s.
        torque_share: share of the torque limits that braking may count on.
        delay: longest delay between a measurement and the torque that follows from it [ticks]. A
            shorter one is safe too.
        box: lowest and highest position of the tool in the world, (2, 3) [m]; None for no limit.
        clearance: least distance of the convex hulls of two links that do not touch by design [m];
            None for no look at collisions. It needs the solver daqp, as `box` does.

    Raises:
        ArgumentError: naming the argument, its value and the remedy.
        MissingDependencyError: by the `Safeguard`, where the solver is not installed.
    """

    arm: Arm
    lower: ArrayLike | None = field(default=None, kw_only=True)
    upper: ArrayLike | None = field(default=None, kw_only=True)
    margin: ArrayLike = field(default=0.02, kw_only=True)
    velocity: ArrayLike | None = field(default=None, kw_only=True)
    velocity_share: float = field(default=0.95, kw_only=True)
    acceleration: ArrayLike | None = field(default=None, kw_only=True)
    braking: ArrayLike | None = field(default=None, kw_only=True)
    torque_share: float = field(default=0.9, kw_only=True)
    delay: int = field(default=5, kw_only=True)
    box: ArrayLike | None = field(default=None, kw_only=True)
    clearance: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        """Check the numbers, and fill in those of the arm."""
        demand_arm(self.arm)
        arm, n = self.arm, self.arm.nv
        lower = self._ends("lower", self.lower, arm.lower_position_limit)
        upper = self._ends("upper", self.upper, arm.upper_position_limit)
        margin = checks.per_joint("margin", self.margin, n, at_least=0.0)
        for j, name in enumerate(arm.joint_names):
            if not lower[j] + 2.0 * margin[j] < upper[j]:
                remedy = f"between {lower[j]:g} and {upper[j]:g} {name} has no room left"
                raise ArgumentError("margin", self.margin, remedy)
        share = checks.finite_number("torque_share", self.torque_share, above=0.0, at_most=1.0)
        checks.finite_number("velocity_share", self.velocity_share, above=0.0, at_most=1.0)
        checks.count("delay", self.delay, at_least=0)
        if self.clearance is not None:
            checks.finite_number("clearance", self.clearance, at_least=0.0)
        if self.box is not None:
            box = checks.finite_array("box", self.box, (2, 3))
            if not (box[0] < box[1]).all():
                raise ArgumentError("box", self.box, "give the lowest position, then the highest")
        velocity = self._positive("velocity", self.velocity, arm.velocity_limit)
        acceleration = self._positive("acceleration", self.acceleration, velocity / QUICKEST_START)
        if self.braking is None:
            braking = available_braking(arm, velocity, share)
        else:
            braking = checks.per_joint("braking", self.braking, n, above=0.0)
        filled = {
            "lower": lower,
            "upper": upper,
            "margin": margin,
            "velocity": velocity,
            "acceleration": acceleration,
            "braking": np.minimum(braking, acceleration),
        }
        for name, value in filled.items():
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    def _ends(self, name: str, given: ArrayLike | None, own: Array) -> Array:
        """Return positions, none of which lies outside the arm's own."""
        if given is None:
            return own.copy()
        return checks.finite_array(name, np.broadcast_to(given, own.shape), own.shape)

    def _positive(self, name: str, given: ArrayLike | None, own: Array) -> Array:
        return own.copy() if given is None else checks.per_joint(name, given, own.size, above=0.0)
