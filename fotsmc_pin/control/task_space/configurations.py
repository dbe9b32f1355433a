"""Configurations inside kernels: each joint's position, and steps from one to another.

A joint has one number in `q`, or the cosine and sine of its angle where it turns without end.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


def places_in_q(arm: Arm) -> NDArray[np.int64]:
    """Return where each joint begins in `q`, and how many numbers it has there (2, nv)."""
    joints = list(arm.model.joints)[1:]
    return np.array([[j.idx_q for j in joints], [j.nq for j in joints]], dtype=np.int64)


@kernel
def difference(q_d: Array, q: Array, places: NDArray[np.int64], out: Array) -> None:
    """Write `q ⊖ q_d` (nv,)."""
    for j in range(out.size):
        k = places[0, j]
        if places[1, j] == 1:
            out[j] = q[k] - q_d[k]
        else:
            sine = q[k + 1] * q_d[k] - q[k] * q_d[k + 1]
            out[j] = math.atan2(sine, q[k] * q_d[k] + q[k + 1] * q_d[k + 1])


@kernel
def step(q: Array, places: NDArray[np.int64], move: Array) -> None:
    """Move `q` (nq,) by the tangent step `move` (nv,)."""
    for j in range(move.size):
        k = places[0, j]
        if places[1, j] == 1:
            q[k] += move[j]
        else:
            c, s = math.cos(move[j]), math.sin(move[j])
            q[k], q[k + 1] = c * q[k] - s * q[k + 1], s * q[k] + c * q[k + 1]
            size = math.hypot(q[k], q[k + 1])
            q[k], q[k + 1] = q[k] / size, q[k + 1] / size
