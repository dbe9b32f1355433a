"""The course of the scenario `task`: a circle and a swing of the tool, well inside of its reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.stress.courses import Course
from fotsmc_pin.references import PoseSwing
from fotsmc_pin.references.poses.inverse import Kinematics, configurations_along

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

POSE_SIZE = 6
"""Directions of a pose, and so the joints that are needed at least."""
TASK_TIME = 8.0
"""Simulated time [s]; the last half is judged."""
CANDIDATES, TRIED = 400, 12
"""Random configurations drawn, and how many of the best conditioned are tried as the middle."""
RADIUS, ANGLE, FASTEST = 0.1, 0.25, 2.0
"""Of the circle over the arm's reach; of the swing [rad]; rate of both [rad/s]."""
LENGTH = 0.3
"""What a radian counts as where singular values are compared, over the arm's reach."""
ROOM = 0.3
"""Room to the joints' ends that the middle has, twice what the way needs [rad, m]."""
EFFORT_SHARE, SPEED_SHARE = 0.6, 0.5
"""Shares of effort limits for gravity, and of velocity limits, that the way may take."""
CONDITION = 0.4
"""Smallest singular value on the way over that in the middle."""
SMALLEST = 0.2
"""Share of the full size below which no smaller one is tried."""


def task(arm: Arm, true: Arm, duration: float = TASK_TIME) -> Course:
    """Return a circle of a tenth of the arm's reach, while the tool swings by 0.25 rad.

    The middle is the best conditioned of a fixed set of random configurations where the arm can
    follow all the way, far from singularities and its joints' ends, with 0.6 of its effort limits
    for the weight of the true arm. Where it nowhere can, the motion is made smaller and slower.

    Args:
        arm: the nominal arm, with six joints or more.
        true: the arm that moves, whose efforts count.
        duration: simulated time [s].

    Raises:
        ArgumentError: the arm has fewer joints than a pose has directions, or nowhere room.
    """
    if arm.nv < POSE_SIZE:
        raise ArgumentError("arm", arm.name, "the scenario task needs six joints or more")
    kinematics = Kinematics(arm, arm.tool_frame_id)
    reach, middles = _middles(kinematics, true)
    size = 1.0
    while size > SMALLEST:
        for q, conditioned in middles:
            swing = PoseSwing(
                center=kinematics.pose(q),
                radius=size * RADIUS * reach,
                angle=size * ANGLE,
                rate=size * FASTEST,
                q_start=q,
            )
            if _can_follow(kinematics, true, swing, reach, CONDITION * conditioned):
                return Course(
                    reference=swing,
                    duration=duration,
                    judged=(0.5 * duration, duration),
                    text=f"move the tool along a circle of {100.0 * swing.radius:.2g} cm while it "
                    f"swings by {swing.angle:.2g} rad, for {duration:g} s",
                )
        size *= 0.8
    raise ArgumentError("arm", arm.name, "the tool has nowhere room for the scenario task")


def _middles(kinematics: Kinematics, true: Arm) -> tuple[float, list[tuple[Array, float]]]:
    """Return the arm's reach, and the best conditioned configurations with their singular value."""
    arm, rng = kinematics.arm, np.random.default_rng(0)
    drawn = [arm.random_configuration(rng) for _ in range(CANDIDATES)]
    places = [kinematics.pose(q).translation for q in drawn]
    reach = float(np.max(np.linalg.norm(np.array(places) - np.mean(places, axis=0), axis=1)))
    found = []
    for q in drawn:
        x = arm.to_joint_positions(q)
        room = np.minimum(x - arm.lower_position_limit, arm.upper_position_limit - x)
        if room.min() < ROOM or _load(true, q) > EFFORT_SHARE:
            continue
        found.append((q, _conditioned(kinematics, q, reach)))
    found.sort(key=lambda pair: -pair[1])
    return reach, found[:TRIED]


def _conditioned(kinematics: Kinematics, q: Array, reach: float) -> float:
    J = kinematics.jacobian(q)
    J[:3] /= LENGTH * reach
    return float(np.linalg.svd(J, compute_uv=False)[-1])


def _load(true: Arm, q: Array) -> float:
    return float(np.max(np.abs(true.gravity(q)) / true.effort_limit))


def _can_follow(
    kinematics: Kinematics, true: Arm, swing: PoseSwing, reach: float, least: float
) -> bool:
    """Return whether the arm can, on a round of both motions."""
    arm, q = kinematics.arm, swing.q_start
    moments = swing.fade + np.linspace(0.0, 4.0 * np.pi / swing.rate, 60)
    motions = [swing(t) for t in moments.tolist()]
    try:
        qs = configurations_along(kinematics, (pose for pose, _, _ in motions), q, "arm")  # type: ignore[arg-type]
    except ArgumentError:
        return False
    for (_, V, _), place in zip(motions, qs, strict=True):
        speed = np.linalg.pinv(kinematics.jacobian(place)) @ V
        if (np.abs(speed) > SPEED_SHARE * arm.velocity_limit).any():
            return False
        if _load(true, place) > EFFORT_SHARE or _conditioned(kinematics, place, reach) < least:
            return False
        x = arm.to_joint_positions(place)
        room = np.minimum(x - arm.lower_position_limit, arm.upper_position_limit - x)
        if room.min() < 0.5 * ROOM:
            return False
    return True
