"""Which link of an arm is its tool: by its usual name, or by its place in the tree."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from fotsmc_pin.arms.tree import UrdfTree

# Names and patterns that manufacturers give to the frame at the tool, best first.
TOOL_FRAMES = (
    "tool0",
    "tcp",
    "*_tcp",
    "gripper_frame_link",
    "tool",
    "*tool_link",
    "*end_effector*",
    "ee_link",
    "link_eef",
    "*_hand",
)

NOTE = "fotsmc_pin"  # Tag that carries the choice, for which URDF has none.


def default_tool_frame(tree: UrdfTree, hand_joints: Collection[str] = ()) -> str:
    """Return a link with a usual tool name, else the last link of the longest chain.

    Chains are as long as they have moving joints, then as they have joints; the first one in the
    file wins a tie. Links beyond `hand_joints`, which are fingers, do not count.
    """

    def length(link: str) -> tuple[int, int]:
        chain = tree.chain(link)
        return sum(joint.moves for joint in chain), len(chain)

    palm = [
        link
        for link in tree.links
        if not any(joint.name in hand_joints for joint in tree.chain(link))
    ]
    longest = max(palm, key=length)
    ends = [link for link in palm if length(link)[0] == length(longest)[0]]
    usual = (link for pattern in TOOL_FRAMES for link in ends if fnmatchcase(link, pattern))
    return next(usual, longest)


def noted_tool_frame(tree: UrdfTree) -> str | None:
    """Return the tool frame that a file written by `Arm.write_urdf` names."""
    note = tree.robot.find(NOTE)
    frame = None if note is None else note.get("tool_frame")
    return frame if frame in tree.links else None


def note_tool_frame(tree: UrdfTree, tool_frame: str) -> None:
    """Write the tool frame into the URDF, which has no tag of its own for it."""
    note = tree.robot.find(NOTE)
    if note is None:
        note = ET.SubElement(tree.robot, NOTE)
    note.set("tool_frame", tool_frame)
