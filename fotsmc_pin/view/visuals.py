"""What an arm looks like: its URDF's visuals as meshes, or capsules where it has none."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import ParseError

import numpy as np

from fotsmc_pin.arms.payload import PREFIX
from fotsmc_pin.view import shapes
from fotsmc_pin.view.mesh_files import read_collada, read_stl
from fotsmc_pin.view.meshes import Mesh
from fotsmc_pin.view.skeleton import skeleton

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.view.meshes import Color


@dataclass(frozen=True, kw_only=True, eq=False)
class Visual:
    """A mesh that is fixed to a joint.

    Attributes:
        name: the URDF's name for it.
        joint: index of the joint in the model; 0 is the world.
        mesh: the triangles, in the joint's frame [m].
        spans: when it is there, from and until [s], None for the run's end; always where empty.
    """

    name: str
    joint: int
    mesh: Mesh
    spans: tuple[tuple[float, float | None], ...] = ()


def visuals_of(arm: Arm) -> list[Visual]:
    """Return everything that shows of `arm`; an arm without visuals is drawn from its joints.

    Warns:
        UserWarning: a mesh cannot be read; the arm is drawn from its joints.
    """
    try:
        items = list(arm.visual_model().geometryObjects)
    except (ValueError, RuntimeError) as error:
        warnings.warn(f"{arm.name} is drawn from its joints alone: {error}", stacklevel=2)
        items = []
    found = [_visual(item) for item in items]
    drawn = [visual for visual in found if visual is not None]
    # Payloads show a ball; they alone do not make a picture of the arm.
    if any(not visual.name.startswith(PREFIX) for visual in drawn):
        return drawn
    bones = [
        Visual(name=name, joint=joint, mesh=mesh)
        for name, joint, mesh in skeleton(arm.model, arm.model.frames[arm.tool_frame_id])
    ]
    return bones + drawn


def _visual(item: Any) -> Visual | None:
    mesh = _mesh(item)
    if mesh is None or not len(mesh.faces):
        return None
    if item.overrideMaterial:
        mesh = mesh.painted(_color(item.meshColor))
    turned = mesh.vertices @ item.placement.rotation.T
    placed = replace(mesh, vertices=turned + item.placement.translation)
    return Visual(name=item.name, joint=int(item.parentJoint), mesh=placed)


def _color(rgba: np.ndarray) -> Color:
    red, green, blue, alpha = (float(x) for x in np.clip(rgba, 0.0, 1.0))
    return (round(red, 4), round(green, 4), round(blue, 4), round(alpha, 4))


def _mesh(item: Any) -> Mesh | None:
    """Return the triangles of a geometry object in its own frame, or None where it has no size."""
    import coal  # type: ignore[import-untyped]

    shape = item.geometry
    if isinstance(shape, coal.BVHModelBase):
        return _from_file(item) or _from_triangles(shape)
    if isinstance(shape, coal.Box):
        return shapes.box(shape.halfSide)
    if isinstance(shape, coal.Sphere):
        return shapes.sphere(shape.radius)
    if isinstance(shape, coal.Cylinder):
        return shapes.cylinder(shape.radius, shape.halfLength)
    if isinstance(shape, coal.Capsule):
        return shapes.capsule(shape.radius, shape.halfLength)
    if isinstance(shape, coal.Cone):
        return shapes.cone(shape.radius, shape.halfLength)
    if isinstance(shape, coal.Ellipsoid):
        return shapes.ellipsoid(shape.radii)
    return _bounding_box(shape)


def _from_file(item: Any) -> Mesh | None:
    """Read the mesh's file for its colours; None where that does not give Pinocchio's triangles."""
    path = Path(item.meshPath)
    readers = {".dae": read_collada, ".stl": read_stl}
    reader = readers.get(path.suffix.lower())
    if reader is None or not path.is_file():
        return None
    try:
        mesh = reader(path)
    except (ValueError, ParseError, OSError):
        return None
    scaled = replace(mesh, vertices=mesh.vertices * item.meshScale)
    item.geometry.computeLocalAABB()
    expected = np.stack([item.geometry.aabb_local.min_, item.geometry.aabb_local.max_])
    used = scaled.vertices[np.unique(scaled.faces)]
    read = np.stack([used.min(axis=0), used.max(axis=0)])
    same = np.allclose(read, expected, atol=1e-3 * float(np.ptp(expected, axis=0).max()))
    return scaled if same else None


def _from_triangles(shape: Any) -> Mesh:
    faces = np.array(
        [[t[0], t[1], t[2]] for t in map(shape.tri_indices, range(shape.num_tris))], dtype=np.int64
    )
    vertices = np.array(shape.vertices(), dtype=np.float64).reshape(-1, 3)
    return Mesh(vertices=vertices, faces=faces, paint=((shapes.GREY, len(faces)),))


def _bounding_box(shape: Any) -> Mesh | None:
    """Stand in for shapes that are rare in URDFs; a plane or half-space has no box."""
    shape.computeLocalAABB()
    low, high = np.array(shape.aabb_local.min_), np.array(shape.aabb_local.max_)
    if not (np.isfinite(low).all() and np.isfinite(high).all()) or np.abs(high - low).max() > 1e6:
        return None
    block = shapes.box((high - low) / 2)
    return replace(block, vertices=block.vertices + (low + high) / 2)
