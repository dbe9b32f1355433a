"""What a page shows of the middle of a run: payloads that come and go, wrenches as arrows."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms.payload import PREFIX
from fotsmc_pin.view import shapes
from fotsmc_pin.view.framing import reach_of, rotations
from fotsmc_pin.view.palette import PAYLOAD_COLOR
from fotsmc_pin.view.visuals import Visual

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array
    from fotsmc_pin.view.meshes import Color
    from fotsmc_pin.view.motion import Motion

ARROW = 0.3
"""Length of the arrow of a run's largest force, over the arm's reach."""


def with_payloads(visuals: Sequence[Visual], recording: Recording) -> list[Visual]:
    """Return the visuals of a run, its payloads' balls with the spans in which they hang there."""
    if not recording.events:
        return [*visuals]
    times = [float(recording.t[0]), *(event.time for event in recording.events)]
    arms = [recording.arm, *(event.arm for event in recording.events)]
    found: dict[Any, Visual] = {}
    for k, (begin, arm) in enumerate(zip(times, arms, strict=True)):
        end = times[k + 1] if k + 1 < len(times) else None
        for visual in _balls(arm):
            key = (visual.joint, visual.mesh.vertices.tobytes())
            known = found.setdefault(key, visual)
            found[key] = replace(known, spans=(*known.spans, (begin, end)))
    others = [visual for visual in visuals if not visual.name.startswith(PREFIX)]
    return [*others, *found.values()]


def _balls(arm: Arm) -> list[Visual]:
    """Return the balls of an arm's payloads, as `perturb` writes them; no mesh is read for it."""
    red, green, blue = (int(PAYLOAD_COLOR[k : k + 2], 16) / 255 for k in (1, 3, 5))
    color: Color = (round(red, 4), round(green, 4), round(blue, 4), 1.0)
    balls = []
    for name, link in arm.tree.links.items():
        sphere = link.find("visual/geometry/sphere") if name.startswith(PREFIX) else None
        if sphere is None:
            continue
        frame = arm.model.frames[arm.model.getFrameId(name)]
        origin = link.find("visual/origin")
        xyz = "0 0 0" if origin is None else origin.get("xyz", "0 0 0")
        center = frame.placement.act(np.array([float(part) for part in xyz.split()]))
        ball = shapes.sphere(float(sphere.get("radius", "0"))).painted(color)
        placed = replace(ball, vertices=ball.vertices + center)
        balls.append(Visual(name=f"{name}_0", joint=int(frame.parentJoint), mesh=placed))
    return balls


def pushes_of(recording: Recording) -> list[dict[str, Any]]:
    """Return a run's wrenches as a page draws them: arrows in metres, fixed to a joint's body.

    "force" and "torque" are arrows in the axes of the world, or of the body where "turns".
    """
    arm = recording.arm
    largest = {
        name: max((float(np.linalg.norm(getattr(w, name))) for w in recording.wrenches), default=0)
        for name in ("force", "torque")
    }
    drawn = []
    for wrench in recording.wrenches:
        frame = arm.model.frames[wrench.frame_id(arm)]
        turn = frame.placement.rotation if wrench.axes == "local" else np.eye(3)
        arrows = {
            name: (ARROW * reach_of(arm) / (size or 1.0) * turn @ getattr(wrench, name)).tolist()
            for name, size in largest.items()
        }
        drawn.append(
            {
                "joint": int(frame.parentJoint),
                "at": frame.placement.translation.tolist(),
                "turns": wrench.axes == "local",
                "start": wrench.start,
                "end": wrench.end,
                "rise": wrench.rise,
                **arrows,
            }
        )
    return drawn


def arrow_tips(recording: Recording, move: Motion, t: Array) -> Array:
    """Return where the arrows of a run's forces end while they act, (n, 3) [m].

    Args:
        recording: the run.
        move: the arm's motion over `K` frames.
        t: times of the frames (K,) [s].
    """
    tips = [np.zeros((0, 3))]
    for push in pushes_of(recording):
        acting = (t >= push["start"]) & (t <= push["end"])
        turns = rotations(move.orientation[acting, push["joint"]])
        arrow = turns @ push["force"] if push["turns"] else push["force"]
        tips.append(move.position[acting, push["joint"]] + turns @ push["at"] + arrow)
    return np.concatenate(tips)
