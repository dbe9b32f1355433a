"""Triangles and material colours of a COLLADA file.

Pinocchio's own loader gives the triangles of a whole file in one colour; robots' files have several
materials. Like that loader, this one takes the file's numbers as metres, with z up, whatever its
header says.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from defusedxml import ElementTree

from fotsmc_pin.view.meshes import Mesh, merged
from fotsmc_pin.view.shapes import GREY

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from fotsmc_pin.view.meshes import Color

    Matrix = NDArray[np.float64]


def read_collada(path: Path) -> Mesh:
    """Return the triangles that the file's scene shows, each in its material's diffuse colour.

    Raises:
        ValueError: the file has no triangles that this reader knows.
        xml.etree.ElementTree.ParseError: it is not XML.
    """
    return _Document(ElementTree.parse(path).getroot()).mesh()


class _Document:
    """One COLLADA file: its elements by id, without the namespace that fills every tag."""

    def __init__(self, root: Element) -> None:
        for element in root.iter():
            element.tag = element.tag.rpartition("}")[2]
        self._root = root
        self._by_id = {e.get("id"): e for e in root.iter() if e.get("id")}

    def mesh(self) -> Mesh:
        parts = [
            part
            for scene in self._root.iter("visual_scene")
            for node in scene.findall("node")
            for part in self._node(node, np.eye(4))
        ]
        if not parts:
            raise ValueError("no triangles")
        return merged(parts)

    def _get(self, reference: str | None) -> Element:
        """Follow a `#reference` to its element."""
        try:
            return self._by_id[(reference or "").removeprefix("#")]
        except KeyError:
            raise ValueError(f"no element {reference}") from None

    def _node(self, node: Element, parent: Matrix) -> Iterator[Mesh]:
        placement = parent @ _placement(node)
        for child in node:
            if child.tag == "node":
                yield from self._node(child, placement)
            elif child.tag == "instance_node":
                yield from self._node(self._get(child.get("url")), placement)
            elif child.tag == "instance_geometry":
                yield from self._geometry(child, placement)

    def _geometry(self, instance: Element, placement: Matrix) -> Iterator[Mesh]:
        colors = {
            bound.get("symbol"): self._color(bound.get("target"))
            for bound in instance.iter("instance_material")
        }
        for mesh in self._get(instance.get("url")).iter("mesh"):
            for primitive in mesh:
                faces = _faces(primitive)
                if faces is None or not len(faces):
                    continue
                vertices = self._positions(primitive) @ placement[:3, :3].T + placement[:3, 3]
                if np.linalg.det(placement[:3, :3]) < 0:
                    faces = faces[:, ::-1]
                color = colors.get(primitive.get("material"), GREY)
                yield Mesh(vertices=vertices, faces=faces, paint=((color, len(faces)),))

    def _positions(self, primitive: Element) -> Matrix:
        vertices = self._get(_input(primitive, "VERTEX").get("source"))
        source = self._get(_input(vertices, "POSITION").get("source"))
        accessor = source.find("technique_common/accessor")
        stride = int(accessor.get("stride", 3)) if accessor is not None else 3
        return _numbers(source.find("float_array"), float).reshape(-1, stride)[:, :3]

    def _color(self, material: str | None) -> Color:
        effect = self._get(self._get(material).find("instance_effect").get("url"))  # type: ignore[union-attr]
        color = effect.find(".//diffuse/color")
        if color is None or not color.text:
            return GREY
        red, green, blue = _numbers(color, float)[:3].clip(0, 1).tolist()
        return (red, green, blue, 1.0)


def _input(element: Element, semantic: str) -> Element:
    for source in element.findall("input"):
        if source.get("semantic") == semantic:
            return source
    raise ValueError(f"no {semantic} input")


def _numbers(element: Element | None, kind: type) -> NDArray[Any]:
    text = element.text if element is not None else None
    return np.array((text or "").split(), dtype=kind)


def _faces(primitive: Element) -> NDArray[np.int64] | None:
    """Return the position indices (F, 3) of a primitive, or None where it is no set of faces."""
    if primitive.tag not in ("triangles", "polylist", "polygons"):
        return None
    stride = max(int(source.get("offset", 0)) for source in primitive.findall("input")) + 1
    offset = int(_input(primitive, "VERTEX").get("offset", 0))
    corners = [_numbers(p, np.int64)[offset::stride] for p in primitive.findall("p")]
    if primitive.tag == "triangles":
        return np.concatenate(corners).reshape(-1, 3) if corners else None
    if primitive.tag == "polygons":
        counts = np.array([len(polygon) for polygon in corners], dtype=np.int64)
    else:
        counts = _numbers(primitive.find("vcount"), np.int64)
    return _fans(np.concatenate(corners), counts) if corners else None


def _fans(corners: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Split polygons with `counts` corners each into triangles around their first corner."""
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    fans = np.maximum(counts - 2, 0)
    first = np.repeat(starts, fans)
    step = np.arange(fans.sum()) - np.repeat(np.cumsum(fans) - fans, fans)
    return np.stack([corners[first], corners[first + step + 1], corners[first + step + 2]], axis=1)


def _placement(node: Element) -> Matrix:
    """Multiply the transforms of a node in the order in which they stand."""
    result = np.eye(4)
    for element in node:
        if element.tag not in ("matrix", "translate", "rotate", "scale"):
            continue
        numbers = _numbers(element, float)
        step = np.eye(4)
        if element.tag == "matrix":
            step = numbers.reshape(4, 4)
        elif element.tag == "translate":
            step[:3, 3] = numbers
        elif element.tag == "scale":
            step[:3, :3] = np.diag(numbers)
        else:
            step[:3, :3] = _rotation(numbers[:3], np.deg2rad(numbers[3]))
        result = result @ step
    return result


def _rotation(axis: Matrix, angle: float) -> Matrix:
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
