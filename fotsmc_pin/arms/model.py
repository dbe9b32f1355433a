"""From a checked URDF to Pinocchio's model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.properties import read_properties

if TYPE_CHECKING:
    from fotsmc_pin.arms.tree import UrdfTree


def build_model(tree: UrdfTree, urdf: str) -> pin.Model:
    """Return Pinocchio's model of a URDF, with armature and limits as `Arm` reads them.

    Raises:
        UrdfError: the parser behind Pinocchio refuses the text.
    """
    try:
        model = pin.buildModelFromXML(urdf)
    except (ValueError, RuntimeError) as error:
        raise tree.fail(f"Pinocchio cannot read it: {error}") from None
    armature = np.zeros(model.nv)
    effort, velocity = np.full(model.nv, np.inf), np.full(model.nv, np.inf)
    lower, upper = model.lowerPositionLimit.copy(), model.upperPositionLimit.copy()
    for number in range(1, model.njoints):
        joint = model.joints[number]
        found = read_properties(tree, tree.joints[model.names[number]])
        armature[joint.idx_v] = found.armature
        effort[joint.idx_v], velocity[joint.idx_v] = found.effort_limit, found.velocity_limit
        if joint.nq == 1:
            lower[joint.idx_q] = found.lower_position_limit
            upper[joint.idx_q] = found.upper_position_limit
    model.armature = armature
    model.upperEffortLimit, model.lowerEffortLimit = effort, -effort
    model.upperVelocityLimit, model.lowerVelocityLimit = velocity, -velocity
    model.lowerPositionLimit, model.upperPositionLimit = lower, upper
    return model
