"""A tool frame for arms whose file marks none beyond the last joint."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.inertia import read_inertia, words

if TYPE_CHECKING:
    from collections.abc import Collection

    from fotsmc_pin.arms.tree import UrdfTree
    from fotsmc_pin.types import Array


TOUCHES = 1e-3
"""A frame this close to a joint's origin lies there [m]."""


def joint_under(tree: UrdfTree, link: str) -> str | None:
    """Return the last moving joint before a link, if the link's origin lies at that joint's."""
    chain = tree.chain(link)
    moving = [joint for joint in chain if joint.moves]
    if not moving or np.linalg.norm(placement(tree, link).translation) > TOUCHES:
        return None
    return moving[-1].name


def place_tool(tree: UrdfTree, link: str, hand_joints: Collection[str]) -> tuple[str, str] | None:
    """Hang a frame on the body of a link, where its tool may be.

    That is half-way between the ends of locked fingers; or twice as far from the last joint as
    the body's centre of mass, where an even rod ends; whichever is farther out.

    Returns:
        The frame's name and what was done in plain words; None where the body tells nothing.
    """
    joint = [joint for joint in tree.chain(link) if joint.moves][-1]
    body = list(tree.rigid_body(joint.child))
    ends = [
        placement(tree, name).translation
        for name in body
        if not tree.joints_below(name) and any(up.name in hand_joints for up in tree.chain(name))
    ]
    guesses = [(2.0 * _centre(tree, body), "twice as far out as the centre of mass")]
    if ends:
        guesses.append((np.mean(ends, axis=0), "half-way between the ends of its fingers"))
    point, how = max(guesses, key=lambda guess: float(np.linalg.norm(guess[0])))
    distance = float(np.linalg.norm(point))
    if distance <= TOUCHES:
        return None
    taken = {element.get("name") for element in tree.robot}
    names = itertools.chain(["tool_point"], (f"tool_point_{k}" for k in itertools.count(2)))
    name = next(name for name in names if not taken & {name, f"{name}_joint"})
    ET.SubElement(tree.robot, "link", name=name)
    fixed = ET.SubElement(tree.robot, "joint", name=f"{name}_joint", type="fixed")
    ET.SubElement(fixed, "parent", link=joint.child)
    ET.SubElement(fixed, "child", link=name)
    ET.SubElement(fixed, "origin", xyz=words(point), rpy="0 0 0")
    return name, (
        f"no link marks the tool: {name} was placed {distance:.3g} m from the origin of "
        f"{joint.name}, {how}; tool_frame chooses another"
    )


def placement(tree: UrdfTree, link: str) -> pin.SE3:
    """Return where a link's frame is, in that of the moving body which it is part of."""
    where = pin.SE3.Identity()
    for joint in reversed(tree.chain(link)):
        if joint.moves:
            break
        origin, name = joint.element.find("origin"), f"joint {joint.name!r}"
        xyz = np.array(tree.numbers(origin, "xyz", (0.0, 0.0, 0.0), name))
        rpy = np.array(tree.numbers(origin, "rpy", (0.0, 0.0, 0.0), name))
        where = pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz) * where
    return where


def _centre(tree: UrdfTree, body: list[str]) -> Array:
    """Return the centre of mass of the links of one body, in its frame, (3,) [m]."""
    total, moment = 0.0, np.zeros(3)
    for link in body:
        inertia = read_inertia(tree, link)
        if inertia is not None:
            total += inertia.mass
            moment += inertia.mass * placement(tree, link).act(inertia.com)
    return moment / total if total > 0.0 else moment
