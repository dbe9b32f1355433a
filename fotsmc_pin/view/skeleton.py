"""An arm drawn from its kinematics alone: capsules along the links, drums at the joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.view import shapes
from fotsmc_pin.view.meshes import Mesh

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fotsmc_pin.types import Array
    from fotsmc_pin.view.meshes import Color


LINK: Color = (0.78, 0.8, 0.83, 1.0)
JOINT: Color = (0.25, 0.28, 0.33, 1.0)
TOOL: Color = (0.9, 0.62, 0.0, 1.0)


def skeleton(model: Any, frame: Any) -> Iterator[tuple[str, int, Mesh]]:
    """Yield name, joint index and mesh of what stands for the links of `model`.

    Args:
        model: the arm's `pinocchio.Model`.
        frame: the frame at the tip, one of `model.frames`.
    """
    thickness = 0.025 * _length(model, frame)
    for child in range(1, model.njoints):
        parent = int(model.parents[child])
        end = np.array(model.jointPlacements[child].translation)
        if np.linalg.norm(end) > thickness:
            yield f"{model.names[parent]}_to_{model.names[child]}", parent, _rod(end, thickness)
        yield model.names[child], child, shapes.sphere(1.3 * thickness).painted(JOINT)
    tip = np.array(frame.placement.translation)
    joint = int(frame.parentJoint)
    if np.linalg.norm(tip) > thickness:
        yield f"{model.names[joint]}_to_{frame.name}", joint, _rod(tip, thickness)
    ball = shapes.sphere(0.9 * thickness).painted(TOOL)
    moved = Mesh(vertices=ball.vertices + tip, faces=ball.faces, paint=ball.paint)
    yield str(frame.name), joint, moved


def _length(model: Any, frame: Any) -> float:
    steps = [np.linalg.norm(model.jointPlacements[j].translation) for j in range(1, model.njoints)]
    length = float(sum(steps) + np.linalg.norm(frame.placement.translation))
    return length if length > 0 else 1.0


def _rod(end: Array, radius: float) -> Mesh:
    """Return a capsule from the origin to `end` [m]."""
    length = float(np.linalg.norm(end))
    rod = shapes.capsule(radius, length / 2)
    z = end / length
    side = np.eye(3)[np.argmin(np.abs(z))]
    x = np.cross(side, z)
    x /= np.linalg.norm(x)
    rotation = np.stack([x, np.cross(z, x), z], axis=1)
    return Mesh(
        vertices=rod.vertices @ rotation.T + end / 2,
        faces=rod.faces,
        paint=((LINK, len(rod.faces)),),
    )
