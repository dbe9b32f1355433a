"""A Panda writes a circle on a tilted plane, with 2 kg at its tool that nobody told it of.

The law acts at the tool: its reference is a pose, its error lies on SE(3). Beside it the same law
learns the weight while it moves.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import fotsmc_pin as fp
from fotsmc_pin.analysis import pose_errors
from fotsmc_pin.references import PoseArc, PoseMotion

DT = 1e-3
TILT = 0.5
"""Of the plane, about the world's y axis [rad]."""
RADIUS = 0.1
"""Of the circle [m]."""


def circle(arm: fp.Arm) -> PoseMotion:
    """Return one circle with the pen upright on the plane, from rest to rest."""
    q = np.array([0.0, -0.2, 0.0, -2.2, 0.0, 2.0, 0.8])  # The tool points straight down.
    plane = pin.rpy.rpyToMatrix(0.0, TILT, 0.0)
    tool = arm.tool_pose(q)
    middle = tool.translation
    start = pin.SE3(plane @ tool.rotation, middle + RADIUS * plane[:, 0])
    path = PoseArc(start, middle, axis=plane[:, 2], angle=2.0 * np.pi)
    return PoseMotion.timed(path, arm, q=q, speed=0.15)


def main(out: Path = Path("out/tilted_circle"), duration: float | None = None) -> fp.Recording:
    """Write the circle for `duration` [s], all of it by default, and make the page."""
    nominal = fp.load_arm("panda")
    true = fp.perturb(nominal, payload=2.0, friction=0.5)
    reference = circle(nominal)
    seconds = reference.duration if duration is None else duration

    runs: dict[str, Any] = {
        "robust": fp.TaskSpace(nominal, DT),
        "robust, learning": fp.ModelLearning(fp.TaskSpace(nominal, DT), delay=0),
    }
    recordings = {}
    for name, law in runs.items():
        rec = recordings[name] = fp.simulate(true, law, reference, seconds)
        error = pose_errors(rec, rec.t >= 0.5 * seconds)
        way, turn = np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1)
        print(f"{name:18} off by {1e3 * way.max():.3f} mm and {1e3 * turn.max():.2f} mrad at most")

    page = fp.export_html(
        recordings, out / "tilted_circle.html", title="A circle on a tilted plane"
    )
    print(f"Open {page} in a browser.")
    return recordings["robust"]


if __name__ == "__main__":
    main()
