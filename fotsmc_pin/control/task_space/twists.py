"""Poses and twists as one frame sees another."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


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
