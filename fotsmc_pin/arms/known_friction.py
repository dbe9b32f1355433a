"""Friction that is known: a word in the file, by which laws feed the file's friction forward."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import TYPE_CHECKING

from fotsmc_pin.arms.markup import parse_urdf
from fotsmc_pin.arms.mounting import noted
from fotsmc_pin.arms.properties import NOTE

if TYPE_CHECKING:
    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.arms.tree import UrdfTree

KNOWN = "known"
"""What this library's tag below `<robot>` says of friction that was measured or identified."""


def with_known_friction(arm: Arm) -> Arm:
    """Return the arm with the word that its friction is that of the real one.

    Laws made for it feed the friction forward. The arms of `identify` and of
    `ModelLearning.learned_arm` have the word already; give it to an arm whose friction you
    measured.
    """
    robot = parse_urdf(arm.urdf, arm.name)
    state_known_friction(robot)
    head, _, _ = arm.urdf.partition("<robot")
    return replace(arm, urdf=head + ET.tostring(robot, encoding="unicode").strip() + "\n")


def friction_is_known(tree: UrdfTree) -> bool:
    """Return whether a file says that its friction is that of the real arm.

    Raises:
        UrdfError: this library's tag below `<robot>` says something else of friction.
    """
    note = tree.robot.find(NOTE)
    said = None if note is None else note.get("friction")
    if said not in (None, KNOWN):
        raise tree.fail(f'<{NOTE} friction="{said}">: write friction="{KNOWN}", or leave it out')
    return said is not None


def state_known_friction(robot: ET.Element) -> None:
    """Write the word into the tag below `<robot>`."""
    noted(robot).set("friction", KNOWN)
