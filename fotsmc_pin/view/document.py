"""The document that a page holds: runs, meshes and view, with its numbers in a `Pack`."""

from __future__ import annotations

import base64
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.view.curves import thinned_curves
from fotsmc_pin.view.framing import Framing, framing
from fotsmc_pin.view.marks import marks_of
from fotsmc_pin.view.mesh_files import PICTURES
from fotsmc_pin.view.meshes import GRID_STEPS, Mesh, thinned
from fotsmc_pin.view.mid_run import arrow_tips, pushes_of, with_payloads
from fotsmc_pin.view.motion import Motion, continuous, frame_rows, motion
from fotsmc_pin.view.palette import GHOST_COLOR, PUSH_COLOR, RUN_COLORS
from fotsmc_pin.view.visuals import visuals_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.view.pack import Pack
    from fotsmc_pin.view.visuals import Visual

FACES_AT_MOST = {"compact": 140_000, "full": 100_000_000}
GAP = 0.15


@dataclass(frozen=True, kw_only=True, eq=False)
class Shot:
    """One run, ready to be shown: frames, their motion, and what the arm looks like."""

    name: str
    recording: Recording
    rows: np.ndarray
    arm: Motion
    ghost: Motion
    visuals: Sequence[Visual]
    framing: Framing
    offset: np.ndarray


def shots_of(
    recordings: Mapping[str, Recording], *, rate: float, quality: str, side_by_side: bool
) -> list[Shot]:
    """Compute the frames of all runs and set them on one floor.

    Args:
        recordings: runs by name.
        rate: frames per second of the run [1/s].
        quality: "compact" thins meshes until all runs fit in a small file, "full" does not.
        side_by_side: whether the arms stand next to each other, from the first one's left to right
            as the camera sees them, instead of in one place.
    """
    shots: list[Shot] = []
    edge = 0.0
    looks: dict[Any, list[Visual]] = {}
    for name, recording in recordings.items():
        arm = recording.arm
        rows = frame_rows(recording.t, rate)
        moves = [motion(arm, recording.q[rows]), motion(arm, recording.q_d[rows])]
        if arm not in looks:
            looks[arm] = visuals_of(arm)
        visuals = with_payloads(looks[arm], recording)
        view = framing(arm, visuals, moves, arrow_tips(recording, moves[0], recording.t[rows]))
        offset = np.zeros(3)
        if side_by_side:
            aside = shots[0].framing.aside if shots else view.aside
            left, right = view.extent(aside)
            offset = (edge - left) * aside if shots else offset
            edge = float(right + offset @ aside + GAP * view.reach)
        shots.append(
            Shot(
                name=name,
                recording=recording,
                rows=rows,
                arm=moves[0],
                ghost=moves[1],
                visuals=visuals,
                framing=view,
                offset=offset,
            )
        )
    return _lightened(shots, FACES_AT_MOST[quality])


def document(shots: Sequence[Shot], options: Mapping[str, Any], pack: Pack) -> dict[str, Any]:
    """Return the JSON document of a page; its arrays go into `pack`.

    Args:
        shots: the runs.
        options: how the page starts (`ghost`, `paths`, `speed`, `loop`, `play`, `theme`);
            `signals`, the names of the signals to plot; and `quality`.
        pack: takes the arrays.
    """
    meshes: list[dict[str, Any]] = []
    numbers: dict[int, int] = {}
    for shot in shots:
        for visual in shot.visuals:
            if id(visual.mesh) not in numbers:
                numbers[id(visual.mesh)] = len(meshes)
                meshes.append(_mesh(visual.mesh, pack, skins=options["quality"] == "full"))
    runs = []
    ghosts: list[Any] = []
    for index, shot in enumerate(shots):
        run = _run(shot, options["signals"], pack)
        run["color"] = RUN_COLORS[index % len(RUN_COLORS)]
        run["visuals"] = [
            {
                "name": v.name,
                "joint": v.joint,
                "mesh": numbers[id(v.mesh)],
                **({"spans": v.spans} if v.spans else {}),
            }
            for v in shot.visuals
        ]
        same_ghost = [run["frames"]["ghost"], run["frames"]["t"], run["offset"]]
        if same_ghost in ghosts:  # One picture of a common reference is enough.
            run["ghost_of"] = ghosts.index(same_ghost)
            del run["frames"]["ghost"], run["frames"]["tool_d"]
        ghosts.append(same_ghost)
        runs.append(run)
    options = {key: value for key, value in options.items() if key not in ("signals", "quality")}
    return {"runs": runs, "meshes": meshes, "view": _view(shots), "options": options}


def _lightened(shots: list[Shot], budget: int) -> list[Shot]:
    """Weld and thin the meshes of all runs; runs of one arm go on sharing theirs."""
    meshes = {id(v.mesh): v.mesh for shot in shots for v in shot.visuals}
    size = max(shot.framing.reach for shot in shots)
    light = dict(zip(meshes, thinned(list(meshes.values()), size, budget), strict=True))
    return [
        Shot(
            **{key: value for key, value in vars(shot).items() if key != "visuals"},
            visuals=[replace(v, mesh=light[id(v.mesh)]) for v in shot.visuals],
        )
        for shot in shots
    ]


def _run(shot: Shot, signals: Sequence[str] | None, pack: Pack) -> dict[str, Any]:
    recording, rows = shot.recording, shot.rows
    arm = recording.arm
    if signals is None:
        signals = [name for name in ("pose_error", "s") if name in recording.signals]
    columns = {"e": recording.e, "tau": recording.tau}
    columns |= {f"signals.{name}": recording.signals[name] for name in signals}
    thin = {name: thinned_curves(recording.t, table) for name, table in columns.items()}
    times, curves = thin["e"][0], {name: table for name, (_, table) in thin.items()}
    whole = len(times) == len(recording.t)
    # Thinned curves keep extremes but not instants; then the numbers of each frame go along.
    sampled = {} if whole else {n: pack.add(columns[n][rows].T) for n in ("e", "tau")}
    return {
        "name": shot.name,
        "arm": arm.name,
        "offset": shot.offset.tolist(),
        "bodies": list(arm.model.names),
        "joints": list(arm.joint_names),
        "units": {"position": list(arm.position_units), "effort": list(arm.effort_units)},
        "effort_limit": [float(x) if np.isfinite(x) else None for x in arm.effort_limit],
        "marks": [vars(mark) for mark in marks_of([recording])],
        "pushes": pushes_of(recording),
        "frames": {
            "t": pack.add(recording.t[rows]),
            "arm": _motion(shot.arm, pack),
            "ghost": _motion(shot.ghost, pack),
            "tool": pack.add(shot.arm.tool.T),
            "tool_d": pack.add(shot.ghost.tool.T),
            **sampled,
            **_axes(recording, rows, pack),
        },
        "charts": {
            "t": pack.add(times),
            "e": pack.add(curves["e"].T),
            "tau": pack.add(curves["tau"].T),
            "signals": {name: pack.add(curves[f"signals.{name}"].T) for name in signals},
        },
    }


def _axes(recording: Recording, rows: np.ndarray, pack: Pack) -> dict[str, Any]:
    """Return where the frame of a task is, and where it is asked to be; nothing of other runs."""
    if "pose_d" not in recording.signals:
        return {}
    poses = np.stack([recording.signals[name][rows] for name in ("pose", "pose_d")], axis=1)
    quaternions = continuous(poses[..., 3:])
    return {
        "axes": {
            "position": pack.add(poses[..., :3].transpose(1, 2, 0)),
            "orientation": pack.add(quaternions.transpose(1, 2, 0)),
        }
    }


def _motion(move: Motion, pack: Pack) -> dict[str, Any]:
    return {
        "position": pack.add(move.position.transpose(1, 2, 0)),
        "orientation": pack.add(move.orientation.transpose(1, 2, 0)),
    }


def _mesh(mesh: Mesh, pack: Pack, *, skins: bool) -> dict[str, Any]:
    """Store vertices as 16-bit steps from the lowest corner; they err by 1/131070 of the size."""
    low, high = mesh.box
    step = max(float((high - low).max()) / GRID_STEPS, 1e-12)
    kind = "u2" if len(mesh.vertices) <= GRID_STEPS else "u4"
    stored: dict[str, Any] = {}
    if skins and mesh.skin is not None:
        images = [_data_address(image) for image in mesh.skin.images]
        stored["skin"] = {"uv": pack.add(mesh.skin.uv), "images": images}
    return stored | {
        "low": low.tolist(),
        "step": step,
        "vertices": pack.add(np.rint((mesh.vertices - low) / step), "u2"),
        "faces": pack.add(mesh.faces, kind),
        "paint": [{"rgba": list(color), "count": count} for color, count in mesh.paint],
    }


def _data_address(image: Path | None) -> str | None:
    if image is None:
        return None
    kind = PICTURES[image.suffix.lower()]
    return f"data:{kind};base64,{base64.b64encode(image.read_bytes()).decode('ascii')}"


def _view(shots: Sequence[Shot]) -> dict[str, Any]:
    lows = [shot.framing.low + shot.offset for shot in shots]
    highs = [shot.framing.high + shot.offset for shot in shots]
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    floor = min(shot.framing.floor for shot in shots)
    outline = np.concatenate([shot.framing.outline + shot.offset for shot in shots])
    return {
        "low": low.tolist(),
        "high": high.tolist(),
        "outline": np.round(outline, 4).tolist(),
        "floor": floor,
        "reach": max(shot.framing.reach for shot in shots),
        "direction": shots[0].framing.direction.tolist(),
        "ghost_color": GHOST_COLOR,
        "push_color": PUSH_COLOR,
    }
