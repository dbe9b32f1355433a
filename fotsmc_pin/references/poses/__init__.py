"""References of poses: `t -> (T, V, A)`, for controllers that work at the tool."""

from fotsmc_pin.references.poses.motion import PoseHold, PoseMotion, PoseSwing
from fotsmc_pin.references.poses.of_joints import PoseOfJoints
from fotsmc_pin.references.poses.path import (
    PoseArc,
    PoseLine,
    PosePath,
    PoseScrew,
    PoseWaypoints,
)

__all__ = [
    "PoseArc",
    "PoseHold",
    "PoseLine",
    "PoseMotion",
    "PoseOfJoints",
    "PosePath",
    "PoseScrew",
    "PoseSwing",
    "PoseWaypoints",
]
