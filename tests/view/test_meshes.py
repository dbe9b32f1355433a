"""Meshes keep their shape when welded and thinned, and simple shapes have the right volume."""

from __future__ import annotations

import numpy as np
import pytest

from fotsmc_pin.view import shapes
from fotsmc_pin.view.meshes import Mesh, merged, thinned, welded

RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)


def volume(mesh: Mesh) -> float:
    """Volume inside a closed surface; positive when its faces look outwards."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


SOLIDS = {
    "box": (shapes.box((0.1, 0.2, 0.3)), 0.2 * 0.4 * 0.6),
    "sphere": (shapes.sphere(0.5), 4 / 3 * np.pi * 0.5**3),
    "cylinder": (shapes.cylinder(0.3, 0.4), np.pi * 0.3**2 * 0.8),
    "capsule": (shapes.capsule(0.2, 0.3), np.pi * 0.2**2 * 0.6 + 4 / 3 * np.pi * 0.2**3),
    "ball": (shapes.capsule(0.2, 0.0), 4 / 3 * np.pi * 0.2**3),
    "cone": (shapes.cone(0.3, 0.2), np.pi * 0.3**2 * 0.4 / 3),
    "ellipsoid": (shapes.ellipsoid((0.1, 0.2, 0.3)), 4 / 3 * np.pi * 0.1 * 0.2 * 0.3),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_a_shape_has_its_volume_and_looks_outwards(name):
    mesh, expected = SOLIDS[name]
    assert volume(mesh) == pytest.approx(expected, rel=0.015)


@pytest.mark.parametrize("name", SOLIDS)
def test_a_shape_is_closed(name):
    mesh, _ = SOLIDS[name]
    edges = np.concatenate([mesh.faces[:, [k, (k + 1) % 3]] for k in range(3)])
    forwards = {tuple(edge) for edge in edges.tolist()}
    assert len(forwards) == len(edges)
    assert forwards == {(b, a) for a, b in forwards}


def test_welding_joins_equal_vertices_and_changes_nothing_else():
    ball = shapes.sphere(0.5)
    loose = Mesh(
        vertices=ball.vertices[ball.faces].reshape(-1, 3),
        faces=np.arange(3 * len(ball.faces)).reshape(-1, 3),
        paint=((RED, 100), (BLUE, len(ball.faces) - 100)),
    )
    joined = welded(loose)
    assert len(joined.vertices) == len(ball.vertices)
    assert len(joined.faces) == len(ball.faces)
    assert joined.paint == loose.paint
    assert volume(joined) == pytest.approx(volume(ball), rel=1e-4)


def test_thinning_keeps_to_its_budget_the_shape_and_the_colours():
    fine = [
        merged([shapes.sphere(0.5).painted(RED), shapes.cylinder(0.1, 1.0).painted(BLUE)]),
        shapes.sphere(0.3),
    ]
    before = sum(len(mesh.faces) for mesh in fine)
    light = thinned(fine, size=20.0, budget=before // 2)
    assert sum(len(mesh.faces) for mesh in light) <= before // 2
    for mesh, original in zip(light, fine, strict=True):
        np.testing.assert_allclose(mesh.box, original.box, atol=0.06)
        assert sum(count for _, count in mesh.paint) == len(mesh.faces)
        assert [color for color, _ in mesh.paint] == [color for color, _ in original.paint]


def test_thinning_leaves_small_parts_there():
    parts = [shapes.sphere(1.0), shapes.box((0.001, 0.001, 0.001))]
    light = thinned(parts, size=10.0, budget=1)
    assert len(light[1].faces) == 12
