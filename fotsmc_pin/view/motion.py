"""Where every joint of an arm is, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


FRAMES_AT_MOST = 3000


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """Placements of all joints (the first is the world) and of the tool over `K` frames.

    Attributes:
        position: origins of the joints (K, J, 3) [m].
        orientation: unit quaternions x, y, z, w of the joints (K, J, 4).
        tool: origin of the tool frame (K, 3) [m].
    """

    position: Array
    orientation: Array
    tool: Array


def frame_rows(t: Array, rate: float) -> NDArray[np.int64]:
    """Choose the rows of a recording that become frames: every so many, and the last.

    Args:
        t: times of the recording (N,) [s].
        rate: frames per second of the run [1/s]; lowered where there would be too many.
    """
    last = len(t) - 1
    wanted = min(max(float(t[-1] - t[0]) * rate, 1.0), FRAMES_AT_MOST)
    stride = max(1, round(last / wanted))
    return np.unique(np.append(np.arange(0, last + 1, stride), last))


def motion(arm: Arm, q: Array) -> Motion:
    """Return the forward kinematics of `arm` at the configurations `q` (K, nq)."""
    model = arm.model
    data = model.createData()
    tool = arm.tool_frame_id
    poses = np.empty((len(q), model.njoints, 7))
    tools = np.empty((len(q), 3))
    for row, configuration in enumerate(np.ascontiguousarray(q)):
        pin.forwardKinematics(model, data, configuration)
        for joint, placement in enumerate(data.oMi):
            poses[row, joint] = pin.SE3ToXYZQUAT(placement)
        tools[row] = pin.updateFramePlacement(model, data, tool).translation
    return Motion(position=poses[..., :3], orientation=continuous(poses[..., 3:]), tool=tools)


def continuous(quaternions: Array) -> Array:
    """Choose of the two quaternions of each rotation the one next to the one before it."""
    turns = np.sum(quaternions[1:] * quaternions[:-1], axis=-1) < 0
    first = np.ones((1, quaternions.shape[1]))
    signs = np.concatenate([first, np.where(turns, -1.0, 1.0)])
    return quaternions * np.cumprod(signs, axis=0)[..., None]
