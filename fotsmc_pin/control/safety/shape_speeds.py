"""How fast the points of a shape can move where the joints before it do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

AXES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
TRAVEL = 1.0
"""Way of a sliding joint that has no end [m]."""


def farthest(arm: Arm, shape: Any) -> Array:
    """Return the largest speed of a point of a shape per speed of each joint, (nv,) [m, 1].

    It is never exceeded: no point is farther from a joint than all links between them in a line.
    Zero for joints that do not move the shape.
    """
    reach = np.zeros(arm.nv)
    model, joint, way = arm.model, shape.parentJoint, extent(shape)
    while joint:
        axis = model.joints[joint]
        if slides(axis):
            ends = arm.lower_position_limit[axis.idx_v], arm.upper_position_limit[axis.idx_v]
            way += max(abs(end) if np.isfinite(end) else TRAVEL for end in ends)
            reach[axis.idx_v] = 1.0
        else:
            reach[axis.idx_v] = way
        way += float(np.linalg.norm(model.jointPlacements[joint].translation))
        joint = model.parents[joint]
    return reach


def speeds(arm: Arm, q: Array, shapes: Iterable[Any]) -> Array:
    """Return the same for each of the shapes, about, in one configuration (shapes, nv)."""
    data = arm.model.createData()
    pin.computeJointJacobians(arm.model, data, q)
    rows = []
    for shape in shapes:
        row = np.zeros(arm.nv)
        if shape.parentJoint:
            J = pin.getJointJacobian(arm.model, data, shape.parentJoint, AXES)
            turning = np.linalg.norm(J[3:], axis=0)
            row = np.linalg.norm(J[:3], axis=0) + extent(shape) * turning
        rows.append(row)
    return np.array(rows)


def slides(joint: Any) -> bool:
    """Return whether a joint slides."""
    return "JointModelP" in joint.shortname()


def extent(shape: Any) -> float:
    """Return how far a shape reaches from the origin of its joint [m]."""
    shape.geometry.computeLocalAABB()
    box = shape.geometry.aabb_local
    corner = np.maximum(np.abs(box.min_), np.abs(box.max_))
    return float(np.linalg.norm(shape.placement.translation) + np.linalg.norm(corner))
