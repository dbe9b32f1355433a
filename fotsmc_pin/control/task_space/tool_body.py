"""The body that a law moves in a task: as many joints as directions, sized like the arm's tool.

A law is made for an arm, from whose limits and inertia some of its gains follow. In a task it is
made for this body, one sliding joint per position and one turning joint per rotation; while it
runs, `M0` and `h0` are those of the tool (`tick.see`), not the body's own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms import Arm
from fotsmc_pin.arms.drive_size import drive_size

if TYPE_CHECKING:
    from fotsmc_pin.control.task_space.directions import Directions
    from fotsmc_pin.types import Array

SAMPLES = 100
"""Random configurations, always the same ones, over which the tool's numbers are taken."""
FASTEST = 10.0
"""Speed that a joint without a limit is taken to have [rad/s, m/s]."""


def reach(arm: Arm, frame: int) -> float:
    """Return how far a frame gets from the first joint that moves it [m], of `SAMPLES` poses."""
    model, data = arm.model, arm.model.createData()
    root = model.supports[model.frames[frame].parentJoint][1]
    distances = []
    for q in _configurations(arm):
        pin.framesForwardKinematics(model, data, q)
        way = data.oMf[frame].translation - data.oMi[root].translation
        distances.append(float(np.linalg.norm(way)))
    return max(distances)


def tool_body(arm: Arm, frame: int, directions: Directions, length: float) -> Arm:
    """Return the body, as an arm of its own.

    Inertia, effort and speed of a direction are the medians, over the arm's poses, of

        ((J M0⁻¹ Jᵀ)⁻¹)_ii,   ((J diag(1/τ_max) Jᵀ)⁻¹)_ii,   min_j q̇_max,j / |J_ij|

    The second is the force that drives in proportion to their limits share among them, which is
    how the inertia of their rotors adds up too: with `τ_max / c` as rotors, it is `c` times theirs.
    """
    model, data = arm.model, arm.model.createData()
    drives = drive_size(arm)
    speeds = np.where(np.isfinite(arm.velocity_limit), arm.velocity_limit, FASTEST)
    names = ("x", "y", "z", "rx", "ry", "rz")
    rows = [names.index(name) for name in directions.names]
    found = []
    for q in _configurations(arm):
        J = pin.computeFrameJacobian(model, data, q, frame, pin.ReferenceFrame.LOCAL)[rows]
        M = arm.mass_matrix(q)
        heavy = np.diag(np.linalg.pinv(J @ np.linalg.solve(M, J.T)))
        strong = np.diag(np.linalg.pinv((J / drives) @ J.T))
        fastest = np.min(speeds / np.maximum(np.abs(J), 1e-3 * length), axis=1)
        found.append([heavy, strong, fastest])
    inertia, effort, speed = np.median(found, axis=0)
    if not np.isfinite(arm.effort_limit).all():
        effort[:] = np.inf
    return Arm(
        urdf=_urdf(directions, inertia, effort, speed),
        name=f"{arm.name} at {model.frames[frame].name}",
        tool_frame=f"link{len(rows)}",
    )


def _configurations(arm: Arm) -> list[Array]:
    rng = np.random.default_rng(0)
    return [arm.random_configuration(rng) for _ in range(SAMPLES)]


def _urdf(directions: Directions, inertia: Array, effort: Array, speed: Array) -> str:
    """Return the body as text, without gravity."""
    parts = ['<robot name="tool"><fotsmc_pin gravity="0.0"/><link name="link0"/>']
    names = directions.names
    mass = max([inertia[k] for k, name in enumerate(names) if name[0] != "r"], default=1.0)
    turn = max([inertia[k] for k, name in enumerate(names) if name[0] == "r"], default=1.0)
    for k, name in enumerate(names):
        kind = "revolute" if name[0] == "r" else "prismatic"
        axis = " ".join("1" if letter == name[-1] else "0" for letter in "xyz")
        last = k == len(names) - 1
        m, i = (mass, turn) if last else (1e-9, 1e-9)
        largest, fastest = effort[k] if np.isfinite(effort[k]) else 0.0, speed[k]
        parts.append(
            f'<joint name="{name}" type="{kind}"><parent link="link{k}"/>'
            f'<child link="link{k + 1}"/><axis xyz="{axis}"/>'
            f'<limit lower="-1e3" upper="1e3" effort="{largest:.9g}" velocity="{fastest:.9g}"/>'
            f'</joint><link name="link{k + 1}"><inertial><mass value="{m:.9g}"/>'
            f'<inertia ixx="{i:.9g}" iyy="{i:.9g}" izz="{i:.9g}" ixy="0" ixz="0" iyz="0"/>'
            "</inertial></link>"
        )
    return "".join([*parts, "</robot>"])
