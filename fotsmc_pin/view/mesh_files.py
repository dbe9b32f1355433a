"""Triangles, colours and pictures of the mesh files that URDFs name: COLLADA and binary STL.

Pinocchio's own loader gives the triangles of a whole file in one colour; robots' files have several
materials. Like that loader, this one takes a file's numbers as metres, with z up, whatever its
header says. Why it is not left to a library: docs/developing.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np
from defusedxml import ElementTree

from fotsmc_pin.view.meshes import Mesh, Skin, merged
from fotsmc_pin.view.shapes import GREY

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from fotsmc_pin.types import Array
    from fotsmc_pin.view.meshes import Color


PICTURES = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
STL_HEADER = 84
STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_collada(path: Path) -> Mesh:
    """Return the triangles that the file's scene shows, each in its material's diffuse look.

    Raises:
        ValueError: the file has no triangles that this reader knows.
        xml.etree.ElementTree.ParseError: it is not XML.
    """
    return _Document(ElementTree.parse(path).getroot(), path.parent).mesh()


def read_stl(path: Path) -> Mesh:
    """Return the triangles of a binary STL file, with three vertices each.

    Raises:
        ValueError: the file is not a binary STL file of the length that its header tells.
    """
    data = path.read_bytes()
    if len(data) < STL_HEADER:
        raise ValueError("too short for an STL file")
    count = int.from_bytes(data[80:STL_HEADER], "little")
    if len(data) != STL_HEADER + count * STL_TRIANGLE.itemsize:
        raise ValueError("not a binary STL file")
    corners = np.frombuffer(data, dtype=STL_TRIANGLE, offset=STL_HEADER)["corners"]
    return Mesh(
        vertices=corners.reshape(-1, 3).astype(np.float64),
        faces=np.arange(3 * count, dtype=np.int64).reshape(-1, 3),
        paint=((GREY, count),),
    )


class _Document:
    """One COLLADA file: its elements by id, without the namespace that fills every tag."""

    def __init__(self, root: Element, folder: Path) -> None:
        self._folder = folder
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

    def _node(self, node: Element, parent: Array) -> Iterator[Mesh]:
        placement = parent @ _placement(node)
        for child in node:
            if child.tag == "node":
                yield from self._node(child, placement)
            elif child.tag == "instance_node":
                yield from self._node(self._get(child.get("url")), placement)
            elif child.tag == "instance_geometry":
                yield from self._geometry(child, placement)

    def _geometry(self, instance: Element, placement: Array) -> Iterator[Mesh]:
        looks = {
            bound.get("symbol"): self._look(bound.get("target"))
            for bound in instance.iter("instance_material")
        }
        for mesh in self._get(instance.get("url")).iter("mesh"):
            for primitive in mesh:
                corners = _corners(primitive)
                if corners is None or not len(corners):
                    continue
                if np.linalg.det(placement[:3, :3]) < 0:
                    corners = corners[:, ::-1]
                positions, number = self._table(primitive, "VERTEX")
                color, image = looks.get(primitive.get("material"), (GREY, None))
                skin = None
                if image is not None:
                    uv, column = self._table(primitive, "TEXCOORD")
                    skin = Skin(uv=uv[corners[..., column], :2], images=(image,))
                yield Mesh(
                    vertices=positions[:, :3] @ placement[:3, :3].T + placement[:3, 3],
                    faces=corners[..., number],
                    paint=((color, len(corners)),),
                    skin=skin,
                )

    def _table(self, primitive: Element, semantic: str) -> tuple[Array, int]:
        """Return the numbers (n, k) behind an input of a primitive, and its place in a corner."""
        entry = _input(primitive, semantic)
        source = self._get(entry.get("source"))
        if source.tag == "vertices":
            source = self._get(_input(source, "POSITION").get("source"))
        accessor = source.find("technique_common/accessor")
        stride = int(accessor.get("stride", 1)) if accessor is not None else 3
        numbers = _numbers(source.find("float_array"), float).reshape(-1, stride)
        return numbers, int(entry.get("offset", 0))

    def _look(self, material: str | None) -> tuple[Color, Path | None]:
        """Return the diffuse colour of a material, or white and its picture."""
        entry = self._get(material).find("instance_effect")
        effect = self._get(entry.get("url") if entry is not None else None)
        color, texture = (effect.find(f".//diffuse/{kind}") for kind in ("color", "texture"))
        if texture is not None:
            return GREY, self._image(effect, texture.get("texture"))
        if color is None or not color.text:
            return GREY, None
        red, green, blue = _numbers(color, float)[:3].clip(0, 1).tolist()
        return (red, green, blue, 1.0), None

    def _image(self, effect: Element, sampler: str | None) -> Path | None:
        """Follow sampler and surface to the file of a picture; None where it is not there."""
        parameters = {p.get("sid"): p for p in effect.iter("newparam")}
        name = sampler
        for step in ("sampler2D/source", "surface/init_from"):
            parameter = parameters.get(name)
            name = parameter.findtext(step) if parameter is not None else name
        image = self._by_id.get(name or "")
        address = image.findtext("init_from") if image is not None else None
        file = self._folder / unquote((address or "").strip().removeprefix("file://"))
        return file if file.suffix.lower() in PICTURES and file.is_file() else None


def _input(element: Element, semantic: str) -> Element:
    for source in element.findall("input"):
        if source.get("semantic") == semantic:
            return source
    raise ValueError(f"no {semantic} input")


def _numbers(element: Element | None, kind: type) -> NDArray[Any]:
    text = element.text if element is not None else None
    return np.array((text or "").split(), dtype=kind)


def _corners(primitive: Element) -> NDArray[np.int64] | None:
    """Return the indices (F, 3, k) at the corners of a primitive, one for each of its k inputs."""
    if primitive.tag not in ("triangles", "polylist", "polygons"):
        return None
    width = max(int(source.get("offset", 0)) for source in primitive.findall("input")) + 1
    rows = [_numbers(p, np.int64).reshape(-1, width) for p in primitive.findall("p")]
    if not rows:
        return None
    if primitive.tag == "triangles":
        return np.concatenate(rows).reshape(-1, 3, width)
    if primitive.tag == "polygons":
        counts = np.array([len(polygon) for polygon in rows], dtype=np.int64)
    else:
        counts = _numbers(primitive.find("vcount"), np.int64)
    return np.concatenate(rows)[_fans(counts)]


def _fans(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return rows (F, 3) that split polygons of `counts` corners around their first corners."""
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    fans = np.maximum(counts - 2, 0)
    first = np.repeat(starts, fans)
    step = np.arange(fans.sum()) - np.repeat(np.cumsum(fans) - fans, fans)
    return np.stack([first, first + step + 1, first + step + 2], axis=1)


def _placement(node: Element) -> Array:
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


def _rotation(axis: Array, angle: float) -> Array:
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
