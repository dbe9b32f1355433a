"""`Room`: how far, how fast and how hard an arm may move while it is excited."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

FULL_SPEED_IN = 0.2
"""Where no acceleration limit is given, the velocity limit may be reached in this time [s]."""
USUAL_SPEED = {"rad": 2.0, "m": 0.5}
"""Velocity limit where the arm gives none [rad/s, m/s]."""
HALF_RANGE = {"rad": np.pi, "m": 0.5}
"""A joint moves at most so far to each side of `arm.neutral`, or of the middle of its range where
neutral is not in it, whatever its limits [rad, m]: cables follow."""
LEAST_EFFORT = 1e-3
"""Where the arm has no effort limit, one is assumed that holds it; at least this [N·m, N]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Room:
    """Bounds on a motion, all (nv,).

    Attributes:
        lower: lowest joint position [rad, m].
        upper: highest joint position [rad, m].
        velocity: largest speed [rad/s, m/s].
        acceleration: largest acceleration [rad/s², m/s²].
        effort: largest effort that the model needs, friction of the arm included [N·m, N].
        effort_limit: the arm's, or what stands for it where it has none.
        full_scale: what the noise of torque readings is a share of: the effort limits, all made
            smaller by one factor where no random state within the bounds needs half of any: files
            state limits that no drive of such an arm has.
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    effort: Array
    effort_limit: Array
    full_scale: Array

    @classmethod
    def of(
        cls,
        arm: Arm,
        *,
        position_margin: float,
        velocity_share: float,
        acceleration_limit: ArrayLike | None,
        effort_share: float,
    ) -> Room:
        """Return the bounds that leave these margins.

        Args:
            arm: the arm.
            position_margin: share of the range left free at each end.
            velocity_share: share of the velocity and acceleration limits in use.
            acceleration_limit: scalar or (nv,); None for the velocity limit within 0.2 s.
            effort_share: share of the effort limits in use.
        """
        margin = checks.finite_number("position_margin", position_margin, at_least=0.0, below=0.5)
        share = checks.finite_number("velocity_share", velocity_share, above=0.0, at_most=1.0)
        effort_share = checks.finite_number("effort_share", effort_share, above=0.0, at_most=1.0)
        units = arm.position_units
        speed = np.where(
            np.isfinite(arm.velocity_limit), arm.velocity_limit, [USUAL_SPEED[u] for u in units]
        )
        if acceleration_limit is None:
            acceleration = speed / FULL_SPEED_IN
        else:
            acceleration = checks.per_joint(
                "acceleration_limit", acceleration_limit, arm.nv, above=0.0
            )
        lower, upper = _range(arm)
        gap = margin * (upper - lower)
        limit = _effort_limit(arm)
        bounds = (lower + gap, upper - gap, share * speed, share * acceleration)
        return cls(
            full_scale=limit * min(1.0, 2.0 * float((_largest_effort(arm, *bounds) / limit).max())),
            lower=lower + gap,
            upper=upper - gap,
            velocity=share * speed,
            acceleration=share * acceleration,
            effort=effort_share * limit,
            effort_limit=limit,
        )

    def draw(self, rng: np.random.Generator) -> Array:
        """Return joint positions, (nv,), uniform in the inner half of the range."""
        middle, half = 0.5 * (self.lower + self.upper), 0.5 * (self.upper - self.lower)
        place: Array = middle + 0.5 * half * rng.uniform(-1.0, 1.0, middle.size)
        return place


def _range(arm: Arm) -> tuple[Array, Array]:
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    half = np.array([HALF_RANGE[unit] for unit in arm.position_units])
    neutral = arm.to_joint_positions(arm.neutral)
    return np.maximum(lower, neutral - half), np.minimum(upper, neutral + half)


def _largest_effort(arm: Arm, lower: Array, upper: Array, v: Array, a: Array) -> Array:
    rng = np.random.default_rng(0)
    efforts = [
        arm.inverse_dynamics(
            arm.from_joint_positions(rng.uniform(lower, upper)),
            v * rng.uniform(-1.0, 1.0, arm.nv),
            a * rng.uniform(-1.0, 1.0, arm.nv),
        )
        for _ in range(200)
    ]
    largest: Array = np.maximum(np.abs(efforts).max(axis=0), LEAST_EFFORT)
    return largest


def _effort_limit(arm: Arm) -> Array:
    limit = arm.effort_limit
    if np.isfinite(limit).all():
        return limit
    rng = np.random.default_rng(0)
    weights = np.abs([arm.gravity(arm.random_configuration(rng)) for _ in range(100)]).max(axis=0)
    # A drive that carries its arm at half of what it can do; a joint without weight to carry
    # gets what it takes to speed up its inertia within a second.
    inertia = np.diag(arm.mass_matrix(arm.neutral))
    assumed = np.maximum(2.0 * weights, np.maximum(10.0 * inertia, LEAST_EFFORT))
    return np.where(np.isfinite(limit), limit, assumed)


def demand_room(arm: Arm, room: Room) -> None:
    """Refuse a joint that has no room to move.

    Raises:
        ArgumentError: naming the joint.
    """
    tight = ~(room.upper - room.lower > 1e-6)
    if tight.any():
        joint = arm.joint_names[int(np.argmax(tight))]
        raise ArgumentError("arm", arm.name, f"joint {joint!r} has no range to move in; lock it")
