"""Time scaling: the times of a path's waypoints under velocity and acceleration limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.checks import per_joint
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.references.path import JointPath
    from fotsmc_pin.types import Array


# Peaks of the rest-to-rest quintic of unit length and time.
PEAK_VELOCITY = 15.0 / 8.0
PEAK_ACCELERATION = 10.0 / np.sqrt(3.0)


def motion_limits(
    arm: Arm, velocity_limit: ArrayLike | None, acceleration_limit: ArrayLike | None
) -> tuple[Array, Array]:
    """Return both limits, (nv,); by default the arm's velocity limit and no acceleration limit."""
    velocity, acceleration = arm.velocity_limit, np.full(arm.nv, np.inf)
    if velocity_limit is not None:
        velocity = per_joint("velocity_limit", velocity_limit, arm.nv, above=0.0)
    if acceleration_limit is not None:
        acceleration = per_joint("acceleration_limit", acceleration_limit, arm.nv, above=0.0)
    return velocity, acceleration


def given_times(times: ArrayLike, waypoints: int) -> Array:
    """Return times of waypoints, (n,) [s], that begin at 0 and increase."""
    vector = np.array(times, dtype=np.float64)
    increasing = vector.shape == (waypoints,) and bool(np.all(np.diff(vector) > 0.0))
    if not increasing or vector[0] != 0.0 or not np.isfinite(vector).all():
        raise ArgumentError("times", times, f"give {waypoints} times that begin at 0 and increase")
    return vector


def rest_to_rest_times(arm: Arm, x: Array, velocity: Array, acceleration: Array) -> Array:
    """Return the shortest times, (n,) [s], in which quintics from rest to rest keep the limits.

    Raises:
        ArgumentError: two equal waypoints in a row, or a joint without limits.
    """
    steps = np.abs(np.diff(x, axis=0))
    for number, step in enumerate(steps):
        if not step.any():
            raise ArgumentError(
                "waypoints", number + 1, "equals the waypoint before it; give times for a pause"
            )
    unlimited = np.isinf(velocity) & np.isinf(acceleration) & steps.any(axis=0)
    if unlimited.any():
        joint = arm.joint_names[int(np.argmax(unlimited))]
        raise ArgumentError("times", None, f"nothing limits {joint}: give times or velocity_limit")
    by_velocity = PEAK_VELOCITY * steps / velocity
    by_acceleration = np.sqrt(PEAK_ACCELERATION * steps / acceleration)
    durations = np.maximum(by_velocity, by_acceleration).max(axis=1)
    return np.concatenate([[0.0], np.cumsum(durations)])


def stretched_to_limits(
    make: Callable[[Array], JointPath], times: Array, velocity: Array, acceleration: Array
) -> Array:
    """Return the times scaled by one factor so that the path just keeps its limits.

    Stretching time by `s` divides velocities by `s` and accelerations by `s²`.
    """
    path = make(times)
    fastest = np.abs(path.extremes(1)[0]).max(axis=0)
    hardest = np.abs(path.extremes(2)[0]).max(axis=0)
    stretch = max(float((fastest / velocity).max()), float(np.sqrt(hardest / acceleration).max()))
    return times * stretch
