"""Frames of an arm by name, and where they sit on their joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.checks import choice

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


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


def mount_of(arm: Arm, frame: int) -> Array:
    """Return where a frame sits on its joint, rotation and origin (4, 3)."""
    placement = arm.model.frames[frame].placement
    return np.vstack([placement.rotation, placement.translation])


def joints_that_move(arm: Arm, frame: int) -> Array:
    """Return 1 for each joint that moves a frame, 0 for the others (nv,)."""
    chain = [int(j) for j in arm.model.supports[arm.model.frames[frame].parentJoint]]
    return np.array([float(k + 1 in chain) for k in range(arm.nv)])
