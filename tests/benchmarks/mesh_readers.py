"""Our reader of mesh files beside trimesh: `python -m tests.benchmarks.mesh_readers`.

Needs trimesh and pycollada (the extra "peers"). Every mesh of an arm is read by both, in turn; then
each makes a page of the arm.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np
import trimesh

import fotsmc_pin as fp
from fotsmc_pin.files import markdown_table
from fotsmc_pin.view import visuals
from fotsmc_pin.view.mesh_files import read_collada, read_stl
from fotsmc_pin.view.meshes import Mesh, merged
from fotsmc_pin.view.shapes import GREY

ARMS = (
    *("panda", "ur3", "ur5", "ur10", "kinova", "xarm7", "z1", "talos_arm", "so100", "so101"),
    *("asr_twodof", "finger_edu", "double_pendulum", "baxter"),
)
HEAD = (
    *("arm", "files", "triangles", "ours [ms]", "trimesh [ms]", "ratio"),
    *("colours differ by", "parts lost", "page [MB]", "by trimesh [MB]"),
)
ROUNDS = 7


def ours(path: Path) -> Mesh:
    return read_collada(path) if path.suffix.lower() == ".dae" else read_stl(path)


def theirs(path: Path) -> Mesh:
    scene = trimesh.load_scene(path, process=False)
    parts = []
    for node in scene.graph.nodes_geometry:
        placement, name = scene.graph[node]
        found = scene.geometry[name]
        material = getattr(found.visual, "material", None)
        color = GREY
        if material is not None and material.baseColorTexture is None:
            red, green, blue = (float(x) / 255.0 for x in material.main_color[:3])
            color = (red, green, blue, 1.0)
        parts.append(
            Mesh(
                vertices=found.vertices @ placement[:3, :3].T + placement[:3, 3],
                faces=np.asarray(found.faces),
                paint=((color, len(found.faces)),),
            )
        )
    return merged(parts)


def colors(mesh: Mesh) -> np.ndarray:
    return np.repeat([c for c, _ in mesh.paint], [n for _, n in mesh.paint], axis=0)


def compare(name: str) -> list[str]:
    arm = fp.load_arm(name)
    items = [item for item in arm.visual_model().geometryObjects if Path(item.meshPath).is_file()]
    paths = [Path(item.meshPath) for item in items]
    spent: dict[str, list[float]] = {"ours": [], "theirs": []}
    for _ in range(ROUNDS):
        for key, reader in (("ours", ours), ("theirs", theirs)):
            started = time.process_time()
            for path in paths:
                reader(path)
            spent[key].append(time.process_time() - started)
    off, missing, faces = 0.0, 0, 0
    for path in paths:
        one, other = ours(path), theirs(path)
        missing += len(one.faces) != len(other.faces)
        faces += len(one.faces)
        if len(one.faces) == len(other.faces):
            off = max(off, float(np.abs(colors(one) - colors(other)).max()))
    mine, peer = (min(times) for times in spent.values())
    kinds = ", ".join(
        f"{sum(p.suffix.lower() == kind for p in paths)} {kind[1:]}"
        for kind in (".dae", ".stl")
        if any(p.suffix.lower() == kind for p in paths)
    )
    return [
        *(name, kinds, str(faces), milliseconds(mine), milliseconds(peer), f"{peer / mine:.1f}"),
        *(f"{off:.3f}", str(missing), f"{page(arm, ours):.2f}", f"{page(arm, theirs):.2f}"),
    ]


def milliseconds(seconds: float) -> str:
    return f"{1e3 * seconds:.3g}" if seconds < 1.0 else f"{1e3 * seconds:.0f}"


def page(arm: fp.Arm, reader: object) -> float:
    """Return the size of a page of the arm at rest [MB]."""
    law = fp.ComputedTorque(arm, 1e-3)
    rec = fp.simulate(arm, law, fp.references.Hold(arm), 0.05)
    with (
        tempfile.TemporaryDirectory() as folder,
        mock.patch.object(visuals, "read_collada", reader),
        mock.patch.object(visuals, "read_stl", reader),
    ):
        return fp.export_html(rec, Path(folder) / "page.html").stat().st_size / 1e6


if __name__ == "__main__":
    rows = [compare(name) for name in sys.argv[1:] or ARMS]
    sys.stdout.write(markdown_table(HEAD, rows, align="ll" + "r" * (len(HEAD) - 2)))
