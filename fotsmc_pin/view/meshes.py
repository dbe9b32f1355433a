"""Triangle meshes: what a page draws, welded and thinned so that the file stays small."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

    Integers: TypeAlias = NDArray[np.int64]

Color: TypeAlias = tuple[float, float, float, float]

GRID_STEPS = 65535
# Cells as fractions of the arm's size, coarser and coarser; the eye does not see the first ones.
CELL_FRACTIONS = (1 / 3000, 1 / 2000, 1 / 1400, 1 / 1000, 1 / 700, 1 / 500, 1 / 350, 1 / 250)


@dataclass(frozen=True, kw_only=True, eq=False)
class Skin:
    """Pictures on a mesh.

    Attributes:
        uv: place in the picture of each corner of each face (F, 3, 2), from its lower left, 0 to 1.
        images: file of the picture for each colour of the mesh's paint; None where there is none.
    """

    uv: Array
    images: tuple[Path | None, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Triangles whose faces are sorted by colour.

    Attributes:
        vertices: corners (V, 3) [m].
        faces: indices into the vertices (F, 3), counter-clockwise seen from outside.
        paint: colours (sRGB and opacity, 0 to 1), each with the number of faces that it covers.
        skin: pictures on the faces, if any.
    """

    vertices: Array
    faces: Integers
    paint: tuple[tuple[Color, int], ...]
    skin: Skin | None = None

    @property
    def box(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the axis-aligned bounding box [m]."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    def painted(self, color: Color) -> Mesh:
        """Return the same triangles in one colour."""
        return Mesh(vertices=self.vertices, faces=self.faces, paint=((color, len(self.faces)),))


def merged(parts: Sequence[Mesh]) -> Mesh:
    """Return one mesh with the triangles of all `parts`."""
    offsets = np.cumsum([0] + [len(part.vertices) for part in parts])
    return Mesh(
        vertices=np.vstack([part.vertices for part in parts]),
        faces=np.vstack([part.faces + o for part, o in zip(parts, offsets, strict=False)]),
        paint=tuple(run for part in parts for run in part.paint),
        skin=_merged_skins(parts),
    )


def welded(mesh: Mesh, cell: float = 0.0) -> Mesh:
    """Return `mesh` with the vertices of each grid cell merged and the collapsed faces dropped.

    Args:
        mesh: what to weld.
        cell: edge of a cell [m]; at least the box over 65535, the resolution that a page stores.

    Returns:
        A mesh whose vertices stand in the order in which the faces use them.
    """
    low, high = mesh.box
    cell = max(cell, float((high - low).max()) / GRID_STEPS, 1e-12)
    keys = np.rint((mesh.vertices - low) / cell).astype(np.int64)
    span = keys.max(axis=0) + 1
    codes = (keys[:, 0] * span[1] + keys[:, 1]) * span[2] + keys[:, 2]
    _, label = np.unique(codes, return_inverse=True)
    count = np.bincount(label)
    centers = np.stack([np.bincount(label, c) / count for c in mesh.vertices.T], axis=1)
    faces = label[mesh.faces]
    a, b, c = faces.T
    kept = (a != b) & (b != c) & (c != a)
    return _in_order_of_use(_with_faces(mesh, kept, centers, faces))


def thinned(meshes: Sequence[Mesh], size: float, budget: int) -> list[Mesh]:
    """Weld all meshes with the finest common cell that keeps them within `budget` faces in all.

    Args:
        meshes: what to thin.
        size: length that the cells are fractions of, such as the reach of the arm [m].
        budget: number of faces; the coarsest cell is taken where none is coarse enough.
    """
    result = [welded(mesh) for mesh in meshes]
    for fraction in CELL_FRACTIONS:
        if sum(len(mesh.faces) for mesh in result) <= budget:
            break
        result = [_welded_unless_lost(mesh, size * fraction) for mesh in result]
    return result


def _welded_unless_lost(mesh: Mesh, cell: float) -> Mesh:
    """Weld, but keep a mesh that is so small that next to nothing of it would be left."""
    coarse = welded(mesh, cell)
    return coarse if len(coarse.faces) >= min(12, len(mesh.faces)) else mesh


def _merged_skins(parts: Sequence[Mesh]) -> Skin | None:
    if all(part.skin is None for part in parts):
        return None
    bare = [
        Skin(uv=np.zeros((len(part.faces), 3, 2)), images=(None,) * len(part.paint))
        for part in parts
    ]
    skins = [part.skin or plain for part, plain in zip(parts, bare, strict=True)]
    return Skin(
        uv=np.concatenate([skin.uv for skin in skins]),
        images=tuple(image for skin in skins for image in skin.images),
    )


def _with_faces(mesh: Mesh, kept: NDArray[np.bool_], vertices: Array, faces: Integers) -> Mesh:
    """Return `mesh` with other vertices and of the new `faces` only the kept ones."""
    ends = np.cumsum([count for _, count in mesh.paint])
    total = np.concatenate([[0], np.cumsum(kept)])
    counts = np.diff(total[np.concatenate([[0], ends])]).tolist()
    paint = tuple((c, n) for (c, _), n in zip(mesh.paint, counts, strict=True) if n > 0)
    skin = None
    if mesh.skin is not None:
        images = zip(mesh.skin.images, counts, strict=True)
        skin = Skin(uv=mesh.skin.uv[kept], images=tuple(image for image, n in images if n > 0))
    return Mesh(vertices=vertices, faces=faces[kept], paint=paint, skin=skin)


def _in_order_of_use(mesh: Mesh) -> Mesh:
    """Renumber the vertices by their first use, which lets the indices compress well."""
    used, first = np.unique(mesh.faces.ravel(), return_index=True)
    order = used[np.argsort(first)]
    rank = np.empty(len(mesh.vertices), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return replace(mesh, vertices=mesh.vertices[order], faces=rank[mesh.faces])
