"""The arithmetic of the plant's integrators between Pinocchio's calls: kernels on one workspace."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.simulation.dry_friction import DEFLECTION, TABLE_ROWS, slide

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


LARGEST_SPEED = 1e4
"""A joint that is faster than this has diverged [rad/s, m/s]."""

# Rows of the plant's workspace. A recorder takes the first three as one.
Q0, V0, TAU, Q_STAGE, V_STAGE, STEP, SUM_V, SUM_A, LOAD = range(9)
DISTURBANCE, DAMPING, FRICTION, EXCESS, STRIBECK, WIDTH, LIMIT = range(9, 16)
TABLE = slice(16, 16 + TABLE_ROWS)
"""Rows of the table of joints with friction or springs; as many as joints follow to factorise."""
CONSTANTS = slice(DAMPING, TABLE.start + DEFLECTION)
"""Rows that an arm gives and no step changes: from its damping to the table's joint state."""
ROWS = 16 + TABLE_ROWS


@kernel
def load(work: Array, v: Array) -> None:
    """What acts on the joints at speed `v`: torque, disturbance and friction."""
    for j in range(v.size):
        friction = work[FRICTION, j]
        if friction > 0.0:
            if work[EXCESS, j] > 0.0:
                ratio = v[j] / work[STRIBECK, j]
                friction *= 1.0 + work[EXCESS, j] * math.exp(-ratio * ratio)
            friction *= math.tanh(v[j] / work[WIDTH, j])
        work[LOAD, j] = work[TAU, j] + work[DISTURBANCE, j] - work[DAMPING, j] * v[j] - friction


@kernel
def begin(work: Array) -> None:
    """Keep the torque within its limits and load the joints with it."""
    for j in range(work.shape[1]):
        work[TAU, j] = min(max(work[TAU, j], -work[LIMIT, j]), work[LIMIT, j])
    load(work, work[V0])


@kernel
def diverged(work: Array) -> int:
    """Index of the first joint whose speed is not finite or beyond reason, or -1."""
    for j in range(work.shape[1]):
        if not abs(work[V0, j]) < LARGEST_SPEED:
            return j
    return -1


@kernel
def rk4_stage(stage: int, h: float, a: Array, work: Array) -> None:
    """Take in the acceleration of `stage` 0, 1 or 2; prepare the next stage."""
    reach = h if stage == 2 else 0.5 * h
    weight = 1.0 if stage == 0 else 2.0
    for j in range(a.size):
        v = work[V0, j] if stage == 0 else work[V_STAGE, j]
        work[SUM_V, j] = weight * v + (0.0 if stage == 0 else work[SUM_V, j])
        work[SUM_A, j] = weight * a[j] + (0.0 if stage == 0 else work[SUM_A, j])
        work[STEP, j] = reach * v
        work[V_STAGE, j] = work[V0, j] + reach * a[j]
        work[Q_STAGE, j] = work[Q0, j] + work[STEP, j]
    load(work, work[V_STAGE])


@kernel
def rk4_finish(h: float, a: Array, work: Array) -> int:
    """Take in the last stage and move; return the index of a joint that diverged, or -1."""
    for j in range(a.size):
        work[STEP, j] = h / 6.0 * (work[SUM_V, j] + work[V_STAGE, j])
        work[V0, j] += h / 6.0 * (work[SUM_A, j] + a[j])
        work[Q0, j] += work[STEP, j]
    load(work, work[V0])
    return diverged(work)


@kernel
def accelerate(h: float, a: Array, work: Array) -> None:
    """Move the velocity over a step of `h` seconds."""
    for j in range(a.size):
        work[V0, j] += h * a[j]


@kernel
def coast(h: float, work: Array) -> int:
    """Move with the new velocity; return the index of a joint that diverged, or -1."""
    move(h, work)
    load(work, work[V0])
    return diverged(work)


@kernel
def move(h: float, work: Array) -> None:
    """Move the positions with the velocity of the end of the step."""
    for j in range(work.shape[1]):
        work[STEP, j] = h * work[V0, j]
        work[Q0, j] += work[STEP, j]


@kernel
def glide(h: float, mass: Array, bias: Array, work: Array) -> int:
    """Move over a step of joints with friction or springs; return as `coast` does."""
    table, factor = work[ROWS - TABLE_ROWS : ROWS], work[ROWS:]
    slide(h, mass, bias, work[TAU], work[DISTURBANCE], work[V0], factor, table)
    move(h, work)
    return diverged(work)
