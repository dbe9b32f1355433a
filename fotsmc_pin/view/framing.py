"""Where the camera stands, from what the arm sweeps and how far it reaches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array
    from fotsmc_pin.view.motion import Motion
    from fotsmc_pin.view.visuals import Visual


THREE_QUARTER_VIEW = np.array([0.84, 0.5, 0.36])
FLAT = 0.08
OUTLINE_DIRECTIONS = 150


@dataclass(frozen=True, kw_only=True, eq=False)
class Framing:
    """A view of an arm.

    Attributes:
        low: lowest corner of the box that the run sweeps (3,) [m].
        high: its highest corner (3,) [m].
        outline: points on the hull of what the run sweeps (n, 3) [m].
        direction: unit vector from the arm to the camera (3,).
        reach: distance from the base to the tool with the arm stretched out, and at least a quarter
            of the box's diagonal, as a tool may lie on the axis of its only joint [m].
        floor: height of the floor [m].
    """

    low: Array
    high: Array
    outline: Array
    direction: Array
    reach: float
    floor: float

    @property
    def aside(self) -> Array:
        """Unit vector to the camera's right, which lies in the horizontal plane (3,)."""
        return _unit(np.cross([0.0, 0.0, 1.0], self.direction))

    def extent(self, axis: Array) -> tuple[float, float]:
        """Return the ends of what the run sweeps along a horizontal axis through the base [m]."""
        along = self.outline @ axis
        return float(along.min()), float(along.max())


def framing(
    arm: Arm, visuals: Sequence[Visual], motions: Sequence[Motion], others: Array | None = None
) -> Framing:
    """Choose the view for an arm that moves like this, and other points (n, 3) [m]."""
    corners = swept_points(visuals, motions)
    if others is not None:
        corners = np.concatenate([corners, others])
    low, high = corners.min(axis=0), corners.max(axis=0)
    reach = max(reach_of(arm), 0.25 * float(np.linalg.norm(high - low)))
    base_height = float(motions[0].position[0, min(1, arm.nv), 2])
    floor = 0.0 if low[2] > -0.05 * reach else float(low[2]) - 0.05 * reach
    floor = min(floor, base_height)
    paths = np.concatenate([m.position[:, 1:].reshape(-1, 3) for m in motions])
    tools = np.concatenate([m.tool for m in motions])
    return Framing(
        low=low,
        high=high,
        outline=_outline(corners),
        direction=_direction(np.concatenate([paths, tools])),
        reach=reach,
        floor=floor,
    )


def swept_points(visuals: Sequence[Visual], motions: Sequence[Motion]) -> Array:
    """Return the corners (n, 3) of all visuals' boxes in some frames of the run [m]."""
    points = [m.tool[_some(len(m.tool))] for m in motions]
    for motion in motions:
        rows = _some(len(motion.tool))
        for visual in visuals:
            low, high = visual.mesh.box
            corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
            local = low + corners * (high - low)
            rotation = rotations(motion.orientation[rows, visual.joint])
            placed = local @ rotation.transpose(0, 2, 1) + motion.position[rows, None, visual.joint]
            points.append(placed.reshape(-1, 3))
    return np.concatenate(points)


def reach_of(arm: Arm) -> float:
    """Return the length of the chain from the first joint to the tool frame [m]."""
    model = arm.model
    frame = model.frames[arm.tool_frame_id]
    length = float(np.linalg.norm(frame.placement.translation))
    joint = int(frame.parentJoint)
    while int(model.parents[joint]) > 0:
        length += float(np.linalg.norm(model.jointPlacements[joint].translation))
        joint = int(model.parents[joint])
    return max(length, 1e-2)


def _direction(points: Array) -> Array:
    """Look at a motion in a plane from the side that shows it; at any other from three quarters."""
    spread, axes = np.linalg.eigh(np.cov(points.T))
    normal = axes[:, 0]
    middle = max(spread[1], 0.0)
    if middle <= 0 or spread[0] > FLAT**2 * middle or abs(normal[2]) > 0.5:
        return _unit(THREE_QUARTER_VIEW)
    if normal @ THREE_QUARTER_VIEW < 0:
        normal = -normal
    side = np.cross([0.0, 0.0, 1.0], normal)
    return _unit(normal + 0.35 * side + np.array([0.0, 0.0, 0.22]))


def _unit(vector: Array) -> Array:
    result: Array = vector / np.linalg.norm(vector)
    return result


def _outline(points: Array) -> Array:
    """Return those points that lie farthest out, in directions spread evenly over the sphere."""
    number = np.arange(OUTLINE_DIRECTIONS) + 0.5
    z = 1 - 2 * number / OUTLINE_DIRECTIONS
    turn = np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - z * z)
    directions = np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)
    extremes: Array = points[np.unique(np.argmax(points @ directions.T, axis=0))]
    return extremes


def _some(count: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, count - 1, min(count, 40)).astype(np.int64))


def rotations(quaternions: Array) -> Array:
    """Return the rotation matrices (K, 3, 3) of unit quaternions x, y, z, w (K, 4)."""
    x, y, z, w = quaternions.T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=-1),
            np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=-1),
            np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=-1),
        ],
        axis=1,
    )
