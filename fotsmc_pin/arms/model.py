"""From a checked URDF to Pinocchio's model."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.inertia import moving_mass
from fotsmc_pin.arms.markup import urdf_text
from fotsmc_pin.arms.mounting import gravity_size
from fotsmc_pin.arms.properties import read_properties

if TYPE_CHECKING:
    from fotsmc_pin.arms.tree import UrdfTree


def build_model(tree: UrdfTree) -> pin.Model:
    """Return Pinocchio's model of a URDF, with armature and limits as `Arm` reads them.

    Raises:
        UrdfError: no joint moves, or one moves no mass; the parser behind Pinocchio refuses the
            file, or reads another mass in it.
    """
    mass = moving_mass(tree)
    try:
        model = pin.buildModelFromXML(urdf_text(_bare(tree)))
    except (ValueError, RuntimeError) as error:
        raise tree.fail(f"Pinocchio cannot read it: {error}") from None
    found = sum(body.mass for body in list(model.inertias)[1:])
    if abs(found - mass) > 1e-9 * mass:
        raise tree.fail(
            f"Pinocchio finds {found:.6g} kg that move, the <inertial> tags say {mass:.6g}; "
            "one of them is not as URDF wants it"
        )
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
    model.gravity.linear = np.array([0.0, 0.0, -gravity_size(tree)])
    model.upperEffortLimit, model.lowerEffortLimit = effort, -effort
    model.upperVelocityLimit, model.lowerVelocityLimit = velocity, -velocity
    model.lowerPositionLimit, model.upperPositionLimit = lower, upper
    return model


def _bare(tree: UrdfTree) -> ET.Element:
    """Return joints, and links with their inertias alone: all that dynamics depend on.

    The parser behind Pinocchio drops whole parts of a link when it stumbles over one of its
    shapes; so it sees no shapes.
    """
    robot = ET.Element("robot", name=tree.robot.get("name") or tree.origin)
    for name, link in tree.links.items():
        ET.SubElement(robot, "link", name=name).extend(link.findall("inertial"))
    robot.extend(joint.element for joint in tree.joints.values())
    return robot
