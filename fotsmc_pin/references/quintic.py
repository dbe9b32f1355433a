"""`Quintic`: from waypoint to waypoint by polynomials of fifth order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.path import JointPath, unwrapped
from fotsmc_pin.references.time_scaling import given_times, motion_limits, rest_to_rest_times

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Quintic(JointPath):
    """Quintics from waypoint to waypoint, at rest at each unless velocities are given.

    Each piece is the polynomial of fifth order that meets position, velocity and zero
    acceleration at both its ends. From rest to rest it is the motion of least jerk.
    """

    @classmethod
    def through(
        cls,
        arm: Arm,
        waypoints: ArrayLike,
        *,
        times: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        velocity_limit: ArrayLike | None = None,
        acceleration_limit: ArrayLike | None = None,
    ) -> Quintic:
        """Plan through waypoints.

        Args:
            arm: the arm.
            waypoints: configurations, (n, nq).
            times: when to reach them, (n,) [s], from 0; by default as soon as the limits allow.
            velocities: at the waypoints, (n, nv) [rad/s or m/s]; needs `times`.
            velocity_limit: scalar or (nv,) [rad/s or m/s]; by default the arm's.
            acceleration_limit: scalar or (nv,) [rad/s² or m/s²]; by default none.

        Raises:
            ArgumentError: unusable arguments, or a limit exceeded: which, where and when.
        """
        x = unwrapped(arm, "waypoints", waypoints)
        if len(x) < 2:
            raise ArgumentError("waypoints", waypoints, "give at least 2")
        velocity, acceleration = motion_limits(arm, velocity_limit, acceleration_limit)
        if times is None:
            if velocities is not None:
                raise ArgumentError("times", None, "velocities at waypoints need times")
            breaks = rest_to_rest_times(arm, x, velocity, acceleration)
        else:
            breaks = given_times(times, len(x))
        v = np.zeros_like(x) if velocities is None else np.array(velocities, dtype=np.float64)
        if v.shape != x.shape or not np.isfinite(v).all():
            raise ArgumentError("velocities", velocities, f"give finite numbers, {x.shape}")
        path = cls(arm=arm, breaks=breaks, coefficients=_pieces(breaks, x, v))
        argument, value = ("waypoints", waypoints) if times is None else ("times", times)
        path.demand_limits(argument, value, velocity, acceleration)
        return path


def _pieces(breaks: Array, x: Array, v: Array) -> Array:
    """Return coefficients, (6, pieces, nv), with zero acceleration where pieces meet."""
    h = np.diff(breaks)[:, np.newaxis]
    step, start, end = np.diff(x, axis=0), v[:-1] * h, v[1:] * h
    zero = np.zeros_like(step)
    # In u = t / h: 10, -15, 6 for the step, the rest for the velocities at both ends.
    third = 10.0 * step - 6.0 * start - 4.0 * end
    fourth = -15.0 * step + 8.0 * start + 7.0 * end
    fifth = 6.0 * step - 3.0 * start - 3.0 * end
    return np.stack([fifth / h**5, fourth / h**4, third / h**3, zero, v[:-1], x[:-1]])
