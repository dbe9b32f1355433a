"""Motions of constant jerk, piece by piece, in one table: what Ruckig plans, evaluated quickly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

BRAKING, MAIN = 2, 7
PIECES = BRAKING + MAIN + 1
"""Of each joint: back within its limits, the seven phases of a motion, and rest."""
NO_BRAKE = (0.0, 0.0)
BEGIN, POSITION, VELOCITY, ACCELERATION, JERK = range(5)


def hold_at(x: Array, table: Array) -> None:
    """Write the rest at `x` (nv,) into the table (5, PIECES, nv)."""
    table[:] = 0.0
    table[BEGIN, 1:] = np.inf
    table[POSITION, 0] = x


def write_plan(profiles: Any, motion: Array, table: Array) -> None:
    """Write what Ruckig planned into the table: each joint's way from its present motion.

    Args:
        profiles: Ruckig's, one for each joint.
        motion: position, velocity and acceleration that it begins with, (3, nv).
        table: (5, PIECES, nv).
    """
    lengths, jerks = [], []
    for profile in profiles:
        brake = profile.brake
        brakes = brake.duration > 0.0
        lengths.append([*(brake.t if brakes else NO_BRAKE), *profile.t])
        jerks.append([*(brake.j if brakes else NO_BRAKE), *profile.j])
    join(np.array([lengths, jerks]), motion, table)


@kernel
def join(plan: Array, motion: Array, table: Array) -> None:
    """Write the pieces of the lengths and jerks `plan` (2, nv, PIECES - 1), one after the other."""
    last = table.shape[1] - 1
    for j in range(motion.shape[1]):
        begin, (x, v, a) = 0.0, (motion[0, j], motion[1, j], motion[2, j])
        for k in range(last):
            s, jerk = plan[0, j, k], plan[1, j, k]
            table[BEGIN, k, j], table[JERK, k, j] = begin, jerk
            table[POSITION, k, j], table[VELOCITY, k, j], table[ACCELERATION, k, j] = x, v, a
            begin += s
            x += s * (v + s * (0.5 * a + s * jerk / 6.0))
            v += s * (a + 0.5 * s * jerk)
            a += s * jerk
        table[BEGIN, last, j], table[POSITION, last, j] = begin, x
        table[VELOCITY, last, j] = table[ACCELERATION, last, j] = table[JERK, last, j] = 0.0


@kernel
def evaluate(t: float, table: Array, motion: Array) -> None:
    """Write position, velocity and acceleration at time `t` into `motion` (3, nv)."""
    for j in range(motion.shape[1]):
        k = 0
        while k + 1 < table.shape[1] and t >= table[BEGIN, k + 1, j]:
            k += 1
        s = max(t - table[BEGIN, k, j], 0.0)
        x, v, a = table[POSITION, k, j], table[VELOCITY, k, j], table[ACCELERATION, k, j]
        jerk = table[JERK, k, j]
        motion[0, j] = x + s * (v + s * (0.5 * a + s * jerk / 6.0))
        motion[1, j] = v + s * (a + 0.5 * s * jerk)
        motion[2, j] = a + s * jerk
