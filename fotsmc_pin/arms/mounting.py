"""Arms on walls and ceilings: gravity in the base's frame, written as a base that is turned.

URDF knows no gravity: it points down by what everybody takes for granted, (0, 0, -9.81) m/s². An
arm that feels another direction is one whose base is turned, so it gets a link above its base and a
fixed joint with the rotation; any program that reads the file sees the same dynamics. A size other
than 9.81 m/s² stands in this library's tag below `<robot>`, which others overlook.
"""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.inertia import words
from fotsmc_pin.arms.properties import NOTE
from fotsmc_pin.arms.tree import UrdfTree
from fotsmc_pin.checks import finite_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array


STANDARD = 9.81
"""Size of gravity where a file says nothing [m/s²]."""


def turn_base(tree: UrdfTree, gravity: ArrayLike) -> tuple[UrdfTree, str]:
    """Turn the base of a tree so that it feels `gravity` (3,) [m/s²], given in the base's frame.

    Returns:
        The tree anew, since it may have a new root, and what was done in plain words.

    Raises:
        ArgumentError: not three finite numbers.
    """
    felt = finite_vector("gravity", gravity, 3)
    size = float(np.linalg.norm(felt))
    note = noted(tree.robot)
    if abs(size - STANDARD) > 1e-9:
        note.set("gravity", repr(size))
    else:
        note.attrib.pop("gravity", None)
    joint = tree.joints.get(note.get("mount", ""))
    if joint is None and (size == 0.0 or np.allclose(felt, (0.0, 0.0, -size), atol=1e-9)):
        return tree, f"gravity is {_shown(felt)}, in the frame of its base"
    element = _new_mount(tree) if joint is None else joint.element
    note.set("mount", element.get("name", ""))
    origin = element.find("origin")
    if origin is None:
        origin = ET.SubElement(element, "origin", xyz="0 0 0")
    origin.set("rpy", words(pin.rpy.matrixToRpy(rotation_to_down(felt))))
    return (
        UrdfTree(tree.robot, tree.origin),
        f"gravity is {_shown(felt)}, in the frame of its base: the base is turned",
    )


def gravity_size(tree: UrdfTree) -> float:
    """Return the size of gravity that a file asks for [m/s²].

    Raises:
        UrdfError: a tag of this library that holds no such number.
    """
    note = tree.robot.find(NOTE)
    (size,) = tree.numbers(note, "gravity", (STANDARD,), f"<{NOTE}>")
    if size < 0.0:
        raise tree.fail(f'<{NOTE} gravity="{size:g}"> is negative; a turned base gives directions')
    return size


def base_gravity(tree: UrdfTree) -> Array:
    """Return gravity (3,) [m/s²] in the frame of the base, below its mount if it has one."""
    down = np.array([0.0, 0.0, -gravity_size(tree)])
    note = tree.robot.find(NOTE)
    joint = None if note is None else tree.joints.get(note.get("mount", ""))
    if joint is None:
        return down
    origin = joint.element.find("origin")
    rpy = tree.numbers(origin, "rpy", (0.0, 0.0, 0.0), f"joint {joint.name!r}")
    felt: Array = pin.rpy.rpyToMatrix(np.array(rpy)).T @ down
    return felt


def rotation_to_down(felt: Array) -> Array:
    """Return the shortest rotation (3, 3) that takes the direction of `felt` to (0, 0, -1)."""
    size = float(np.linalg.norm(felt))
    if size == 0.0:
        return np.eye(3)
    direction, down = felt / size, np.array([0.0, 0.0, -1.0])
    axis, cosine = np.cross(direction, down), float(direction @ down)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:  # Upright; or from a ceiling, where half a turn about x is as short as any.
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    rotation: Array = pin.exp3(np.arctan2(sine, cosine) * axis / sine)
    return rotation


def noted(robot: ET.Element) -> ET.Element:
    """Return this library's tag below `<robot>`, made if it is not there."""
    note = robot.find(NOTE)
    return ET.SubElement(robot, NOTE) if note is None else note


def _new_mount(tree: UrdfTree) -> ET.Element:
    """Put a link above the base and return the fixed joint between them."""
    taken = {element.get("name") for element in tree.robot}
    names = itertools.chain(["mount"], (f"mount_{number}" for number in itertools.count(2)))
    name = next(name for name in names if not taken & {name, f"{name}_joint"})
    ET.SubElement(tree.robot, "link", name=name)
    element = ET.SubElement(tree.robot, "joint", name=f"{name}_joint", type="fixed")
    ET.SubElement(element, "parent", link=name)
    ET.SubElement(element, "child", link=tree.root)
    return element


def _shown(felt: Array) -> str:
    return f"({', '.join(f'{part:.4g}' for part in felt)}) m/s²"
