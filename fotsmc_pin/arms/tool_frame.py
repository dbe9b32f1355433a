"""Which link of an arm is its tool: by its usual name, or by its place in the tree."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from fotsmc_pin.arms.mounting import noted
from fotsmc_pin.arms.properties import NOTE
from fotsmc_pin.arms.tool_point import joint_under, place_tool

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


def default_tool_frame(tree: UrdfTree, hand_joints: Collection[str] = ()) -> tuple[str, list[str]]:
    """Return a link with a usual tool name, else the last link of the longest chain.

    Chains are as long as they have moving joints, then as they have joints; the first one in the
    file wins a tie. Links beyond `hand_joints`, which are fingers, do not count. Where that link
    lies at the origin of the last joint, and bears no usual name, a frame is placed in the tree
    beyond it, which `place_tool` describes.

    Returns:
        The frame's name, and what is worth knowing about it in plain words.
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
    usual = [link for pattern in TOOL_FRAMES for link in ends if fnmatchcase(link, pattern)]
    if not usual and joint_under(tree, longest) is not None:
        placed = place_tool(tree, longest, hand_joints)
        if placed is not None:
            return placed[0], [placed[1]]
    return next(iter(usual), longest), []


def noted_tool_frame(tree: UrdfTree) -> str | None:
    """Return the tool frame that a file written by `Arm.write_urdf` names."""
    note = tree.robot.find(NOTE)
    frame = None if note is None else note.get("tool_frame")
    return frame if frame in tree.links else None


def note_tool_frame(tree: UrdfTree, tool_frame: str) -> None:
    """Write the tool frame into the URDF, which has no tag of its own for it."""
    noted(tree.robot).set("tool_frame", tool_frame)
