"""The simple shapes of a URDF as triangles: box, and bodies of revolution about z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.view.meshes import Mesh

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.view.meshes import Color

SEGMENTS = 40
GREY: Color = (0.9, 0.9, 0.9, 1.0)


def box(half_side: Sequence[float]) -> Mesh:
    """Return a box centred on the origin with the given half sides (3,) [m]."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return _mesh(corners * np.asarray(half_side, dtype=float), np.array(faces))


def sphere(radius: float) -> Mesh:
    """Return a sphere centred on the origin [m]."""
    return revolved(_arc(radius, -np.pi / 2, np.pi / 2))


def ellipsoid(radii: Sequence[float]) -> Mesh:
    """Return an ellipsoid centred on the origin with the given radii (3,) [m]."""
    ball = sphere(1.0)
    return _mesh(ball.vertices * np.asarray(radii, dtype=float), ball.faces)


def cylinder(radius: float, half_length: float) -> Mesh:
    """Return a cylinder along z, centred on the origin [m]."""
    profile = [(0, -half_length), (radius, -half_length), (radius, half_length), (0, half_length)]
    return revolved(profile)


def capsule(radius: float, half_length: float) -> Mesh:
    """Return a cylinder along z of the given half length with a half ball on each end [m]."""
    lower = [(r, z - half_length) for r, z in _arc(radius, -np.pi / 2, 0.0)]
    upper = [(r, z + half_length) for r, z in _arc(radius, 0.0, np.pi / 2)]
    return revolved(lower + upper if half_length > 0 else lower + upper[1:])


def cone(radius: float, half_length: float) -> Mesh:
    """Return a cone along z with its tip up, centred on the origin [m]."""
    return revolved([(0, -half_length), (radius, -half_length), (0, half_length)])


def revolved(profile: Sequence[tuple[float, float]]) -> Mesh:
    """Return the surface that a profile of (radius, z) points from bottom to top sweeps [m].

    The first and the last point must lie on the axis.
    """
    turn = 2 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    inner = np.array(profile[1:-1], dtype=float)
    rings = np.stack(
        [
            np.outer(inner[:, 0], np.cos(turn)),
            np.outer(inner[:, 0], np.sin(turn)),
            np.repeat(inner[:, 1:], SEGMENTS, axis=1),
        ],
        axis=-1,
    ).reshape(-1, 3)
    bottom, top = len(rings), len(rings) + 1
    here, there = np.arange(SEGMENTS), (np.arange(SEGMENTS) + 1) % SEGMENTS
    last = (len(inner) - 1) * SEGMENTS
    faces = [np.stack([np.full(SEGMENTS, bottom), there, here], axis=1)]
    for ring in range(len(inner) - 1):
        a, b = ring * SEGMENTS + here, ring * SEGMENTS + there
        faces.append(np.stack([a, b, b + SEGMENTS], axis=1))
        faces.append(np.stack([a, b + SEGMENTS, a + SEGMENTS], axis=1))
    faces.append(np.stack([np.full(SEGMENTS, top), last + here, last + there], axis=1))
    poles = [[0, 0, profile[0][1]], [0, 0, profile[-1][1]]]
    return _mesh(np.vstack([rings, poles]), np.vstack(faces))


def _arc(radius: float, start: float, stop: float) -> list[tuple[float, float]]:
    steps = max(2, round(SEGMENTS / 2 * (stop - start) / np.pi))
    angles = np.linspace(start, stop, steps + 1)
    cosines = np.where(np.isclose(np.abs(angles), np.pi / 2), 0.0, np.cos(angles))
    return [
        (radius * float(c), radius * float(s)) for c, s in zip(cosines, np.sin(angles), strict=True)
    ]


def _mesh(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    faces = faces.astype(np.int64)
    return Mesh(vertices=vertices, faces=faces, paint=((GREY, len(faces)),))
