"""`MinimumJerk`: through waypoints without a stop, with the least jerk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.path import JointPath, unwrapped
from fotsmc_pin.references.spline import spline_pieces
from fotsmc_pin.references.time_scaling import (
    given_times,
    motion_limits,
    rest_to_rest_times,
    stretched_to_limits,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class MinimumJerk(JointPath):
    """The path through waypoints, at rest at both ends, whose `∫ |jerk|² dt` is least.

    It is the quintic spline with four continuous derivatives: among all functions that meet the
    waypoints at their times and rest at both ends, none has less (the variational property of
    splines of odd order, Schoenberg 1964; for arm motions Flash and Hogan 1985).
    """

    @classmethod
    def through(
        cls,
        arm: Arm,
        waypoints: ArrayLike,
        *,
        times: ArrayLike | None = None,
        velocity_limit: ArrayLike | None = None,
        acceleration_limit: ArrayLike | None = None,
    ) -> MinimumJerk:
        """Plan through waypoints.

        Args:
            arm: the arm.
            waypoints: configurations, (n, nq).
            times: when to reach them, (n,) [s], from 0. By default the pieces get times in
                proportion to what each needs from rest to rest, and all are scaled by one factor
                so that the path just keeps its limits.
            velocity_limit: scalar or (nv,) [rad/s or m/s]; by default the arm's.
            acceleration_limit: scalar or (nv,) [rad/s² or m/s²]; by default none.

        Raises:
            ArgumentError: unusable arguments, or a limit exceeded: which, where and when.
        """
        x = unwrapped(arm, "waypoints", waypoints)
        if len(x) < 2:
            raise ArgumentError("waypoints", waypoints, "give at least 2")
        velocity, acceleration = motion_limits(arm, velocity_limit, acceleration_limit)

        def make(breaks: Array) -> MinimumJerk:
            breaks, coefficients = spline_pieces(breaks, x)
            return cls(arm=arm, breaks=breaks, coefficients=coefficients)

        if times is None:
            breaks = rest_to_rest_times(arm, x, velocity, acceleration)
            path = make(stretched_to_limits(make, breaks, velocity, acceleration))
            path.demand_limits("waypoints", waypoints, velocity, acceleration)
        else:
            path = make(given_times(times, len(x)))
            path.demand_limits("times", times, velocity, acceleration)
        return path
