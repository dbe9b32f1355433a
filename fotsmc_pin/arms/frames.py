"""Frames of an arm by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.checks import choice

if TYPE_CHECKING:
    from fotsmc_pin.arms.arm import Arm


def frame_id(arm: Arm, name: str | None) -> int:
    """Return the index of a frame among `arm.model.frames`; of the tool frame if None.

    Raises:
        ArgumentError: no moving link or frame has that name.
    """
    if name is None or name == arm.tool_frame:
        return arm.tool_frame_id
    moving = [k for k, frame in enumerate(arm.model.frames) if frame.parentJoint > 0]
    names = {arm.model.frames[k].name: k for k in moving}
    return names[choice("frame", name, [*names])]
