"""Triangles of a binary STL file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.view.meshes import Mesh
from fotsmc_pin.view.shapes import GREY

if TYPE_CHECKING:
    from pathlib import Path

HEADER = 84
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: Path) -> Mesh:
    """Return the triangles of a binary STL file, with three vertices each.

    Raises:
        ValueError: the file is not a binary STL file of the length that its header tells.
    """
    data = path.read_bytes()
    if len(data) < HEADER:
        raise ValueError("too short for an STL file")
    count = int.from_bytes(data[80:HEADER], "little")
    if len(data) != HEADER + count * TRIANGLE.itemsize:
        raise ValueError("not a binary STL file")
    corners = np.frombuffer(data, dtype=TRIANGLE, offset=HEADER)["corners"]
    return Mesh(
        vertices=corners.reshape(-1, 3).astype(np.float64),
        faces=np.arange(3 * count, dtype=np.int64).reshape(-1, 3),
        paint=((GREY, count),),
    )
