"""Where the tool is and how it moves, from what Pinocchio writes of the joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.task_space.pose_log import cross

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@kernel
def tool_motion(
    turn: Array, place: Array, columns: Array, rates: Array, mount: Array,
    moves: Array, v: Array,
    pose: Array, J: Array, twist: Array, bias: Array,
) -> None:  # fmt: skip
    """Write the tool's pose, its Jacobian `J`, its twist `J v` and `J̇ v`, in its own axes.

    Args:
        turn: rotation of the joint that carries the tool (3, 3).
        place: origin of that joint (3,) [m].
        columns: Jacobian of all joints in the world, as `data.J` (6, nv).
        rates: its derivative, as `data.dJ` (6, nv).
        mount: the tool's place on that joint, rotation and origin (4, 3).
        moves: 1 for the joints that move the tool, 0 for others (nv,).
        v: speed of the joints (nv,).
        pose: rows of rotation, and the origin (4, 3), overwritten.
        J: (6, nv), overwritten.
        twist: (6,), overwritten.
        bias: (6,), overwritten.
    """
    R, p = pose[:3], pose[3]
    for i in range(3):
        p[i] = place[i]
        for j in range(3):
            p[i] += turn[i, j] * mount[3, j]
            R[i, j] = 0.0
            for k in range(3):
                R[i, j] += turn[i, k] * mount[k, j]
    twist[:] = 0.0
    bias[:] = 0.0
    for c in range(v.size):
        if moves[c] == 0.0:
            J[:, c] = 0.0
            continue
        # (v + ω × p, ω) of each column, turned into the tool's axes
        w0, w1, w2 = columns[3, c], columns[4, c], columns[5, c]
        l0 = columns[0, c] + w1 * p[2] - w2 * p[1]
        l1 = columns[1, c] + w2 * p[0] - w0 * p[2]
        l2 = columns[2, c] + w0 * p[1] - w1 * p[0]
        a0, a1, a2 = rates[3, c], rates[4, c], rates[5, c]
        b0 = rates[0, c] + a1 * p[2] - a2 * p[1]
        b1 = rates[1, c] + a2 * p[0] - a0 * p[2]
        b2 = rates[2, c] + a0 * p[1] - a1 * p[0]
        for i in range(3):
            J[i, c] = R[0, i] * l0 + R[1, i] * l1 + R[2, i] * l2
            J[3 + i, c] = R[0, i] * w0 + R[1, i] * w1 + R[2, i] * w2
            twist[i] += J[i, c] * v[c]
            twist[3 + i] += J[3 + i, c] * v[c]
            bias[i] += (R[0, i] * b0 + R[1, i] * b1 + R[2, i] * b2) * v[c]
            bias[3 + i] += (R[0, i] * a0 + R[1, i] * a1 + R[2, i] * a2) * v[c]


@kernel
def seen_from(pose_d: Array, pose: Array, X: Array) -> None:
    """Write `X = T_d⁻¹ T`, rotation and origin (4, 3)."""
    for i in range(3):
        X[3, i] = 0.0
        for k in range(3):
            X[3, i] += pose_d[k, i] * (pose[3, k] - pose_d[3, k])
        for j in range(3):
            X[i, j] = 0.0
            for k in range(3):
                X[i, j] += pose_d[k, i] * pose[k, j]


@kernel
def carried(X: Array, twist: Array, out: Array) -> None:
    """Write a twist of the reference as one of the tool, `Ad(X)⁻¹ V` (6,), in the tool's axes."""
    l0 = twist[0] + twist[4] * X[3, 2] - twist[5] * X[3, 1]
    l1 = twist[1] + twist[5] * X[3, 0] - twist[3] * X[3, 2]
    l2 = twist[2] + twist[3] * X[3, 1] - twist[4] * X[3, 0]
    for i in range(3):
        out[i] = X[0, i] * l0 + X[1, i] * l1 + X[2, i] * l2
        out[3 + i] = X[0, i] * twist[3] + X[1, i] * twist[4] + X[2, i] * twist[5]


@kernel
def twist_cross(a: Array, b: Array, out: Array, s: Array) -> None:
    """Subtract the cross product of two twists from `out` (6,): `out - a × b`; `s` is scratch."""
    cross(a[3:], b[:3], s)
    for i in range(3):
        out[i] -= s[i]
    cross(a[:3], b[3:], s)
    for i in range(3):
        out[i] -= s[i]
    cross(a[3:], b[3:], s)
    for i in range(3):
        out[3 + i] -= s[i]


@kernel
def quaternion(pose: Array, out: Array) -> None:
    """Write a pose (4, 3) as its origin and a unit quaternion x, y, z, w (7,)."""
    R = pose[:3]
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    big = 3
    for i in range(3):
        out[i] = pose[3, i]
        if R[i, i] > (trace if big == 3 else R[big, big]):
            big = i
    if big == 3:
        real = 0.5 * math.sqrt(max(1.0 + trace, 0.0))
        out[6] = real
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            out[3 + i] = (R[k, j] - R[j, k]) / (4.0 * real)
    else:
        j, k = (big + 1) % 3, (big + 2) % 3
        own = 0.5 * math.sqrt(max(1.0 + R[big, big] - R[j, j] - R[k, k], 0.0))
        out[3 + big] = own
        out[3 + j] = (R[j, big] + R[big, j]) / (4.0 * own)
        out[3 + k] = (R[k, big] + R[big, k]) / (4.0 * own)
        out[6] = (R[k, j] - R[j, k]) / (4.0 * own)
