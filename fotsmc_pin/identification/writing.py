"""Identified numbers written into the URDF of an arm; everything else in it stays."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.inertia import LinkInertia, read_inertia, write_inertia
from fotsmc_pin.arms.known_friction import state_known_friction
from fotsmc_pin.arms.markup import parse_urdf, urdf_text
from fotsmc_pin.arms.properties import write_properties
from fotsmc_pin.arms.tool_point import placement
from fotsmc_pin.arms.tree import UrdfTree
from fotsmc_pin.identification.consistent import can_exist

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.regressor import Parameters
    from fotsmc_pin.types import Array


def written(
    arm: Arm,
    theta: Array,
    parameters: Parameters,
    *,
    name: str,
    changes: Sequence[str],
    stribeck_velocity: float,
) -> Arm:
    """Return the arm with the parameters written in.

    Args:
        arm: the nominal arm.
        theta: parameters (p,) of bodies that can exist.
        parameters: their order.
        name: of the new arm.
        changes: what was done, in plain words.
        stribeck_velocity: speed of the fall of friction from standstill on [rad/s, m/s].
    """
    tree = UrdfTree(parse_urdf(arm.urdf, arm.name), arm.name)
    values = {kind: theta[place] for kind, place in parameters.groups.items()}
    for k, joint in enumerate(arm.joint_names):
        write_body(tree, joint, theta[parameters.body(k)])
        own = {kind: float(values[kind][k]) for kind in ("armature", "damping", "friction")}
        if "stribeck" in values:
            rubs = own["friction"] > 0.0
            more = float(values["stribeck"][k]) / own["friction"] if rubs else 0.0
            own |= {"stiction": 1.0 + more, "stribeck_velocity": stribeck_velocity}
        write_properties(tree, tree.joints[joint], own)
    state_known_friction(tree.robot)
    every = (*arm.changes, *changes)
    comment = "\n".join([f"Changes to {arm.name}:", *(f"  {change}" for change in every)])
    return replace(arm, urdf=urdf_text(tree.robot, comment), name=name, changes=every)


def write_body(tree: UrdfTree, joint: str, dynamic: Array) -> None:
    """Write the ten parameters of the body behind a joint.

    The heaviest link of the body takes what the others leave; where that could not exist, it takes
    everything and the others lose their inertia.
    """
    links = list(tree.rigid_body(tree.joints[joint].child))
    found = {link: inertia for link in links if (inertia := read_inertia(tree, link)) is not None}
    host = max(found, key=lambda link: found[link].mass)
    others = [link for link in found if link != host]
    rest = dynamic - sum(
        (_in_joint(tree, link, found[link]).toDynamicParameters() for link in others),
        np.zeros(10),
    )
    if not can_exist(rest):
        rest = dynamic
        for link in others:
            element = tree.links[link]
            for inertial in element.findall("inertial"):
                element.remove(inertial)
    body = placement(tree, host).actInv(pin.Inertia.FromDynamicParameters(rest))
    about = np.array(body.inertia)
    write_inertia(
        tree.links[host],
        LinkInertia(
            mass=float(body.mass),
            com=np.array(body.lever),
            rpy=np.zeros(3),
            about_com=0.5 * (about + about.T),
        ),
    )


def _in_joint(tree: UrdfTree, link: str, inertia: LinkInertia) -> pin.Inertia:
    """Return the inertia of a link in the frame of the joint that moves it."""
    turn = pin.rpy.rpyToMatrix(inertia.rpy)
    own = pin.Inertia(inertia.mass, inertia.com, turn @ inertia.about_com @ turn.T)
    return placement(tree, link).act(own)
