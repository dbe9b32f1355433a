"""One tick of learning: the pieces of the estimator, spread so that no tick is much longer."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from fotsmc_pin.compiled import kernel
from fotsmc_pin.learning.estimator import (
    WINDOW,
    JointRows,
    absorb,
    close_window,
    collect,
    drift,
    keep_possible,
    take_row,
)
from fotsmc_pin.learning.parameters import Beliefs
from fotsmc_pin.learning.trust import body, trust

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class Clock(NamedTuple):
    """Numbers of the whole arm.

    Attributes:
        ticks: how many there were.
        elapsed: since the window began [s].
        duration: of the last window [s]; 0 before there was one.
        tool: index of the link that carries the tool.
        lowest: ratio of true to believed inertia down to which the loop is used.
        highest: the same, upward.
        fall: speed at which friction falls [rad/s].
    """

    ticks: float
    elapsed: float
    duration: float
    tool: float
    lowest: float
    highest: float
    fall: float


@kernel(rounds_freely=True)
def learn(
    dt: float,
    tau: Array,
    v: Array,
    clock: Array,
    sent: Array,
    joint_table: Array,
    belief_table: Array,
    P: Array,
    Y: Array,
    regressor: Array,
    bodies: Array,
    dynamic: Array,
) -> None:
    """Learn from one tick, and write the dynamic parameters of one link.

    Args:
        dt: time since the last tick [s].
        tau: torque that was just sent (nv,).
        v: measured speed (nv,).
        clock: row of `Clock`.
        sent: torques sent but not yet applied (delay + 1, nv), the oldest first; moved on.
        joint_table: rows of `JointRows`.
        belief_table: rows of `Beliefs`.
        P: covariance (p, p).
        Y: low-passed rows (nv, c).
        regressor: Pinocchio's, of the last window; new at the first tick of each (nv, 10 nv).
        bodies: dynamic parameters per unit of each column (nv + 4, 10).
        dynamic: overwritten with those of a link, another one in each tick but a window's first.
    """
    n, delay = v.size, sent.shape[0] - 1
    x = JointRows(
        joint_table[0],
        joint_table[1],
        joint_table[2],
        joint_table[3],
        joint_table[4],
        joint_table[5],
        joint_table[6],
        joint_table[7],
        joint_table[8],
        joint_table[9],
        joint_table[10],
        joint_table[11],
    )
    b = Beliefs(
        belief_table[0],
        belief_table[1],
        belief_table[2],
        belief_table[3],
        belief_table[4],
        belief_table[5],
        belief_table[6],
    )
    ticks = int(clock[0])
    phase = ticks % WINDOW
    tool = int(clock[3])
    if ticks > 0:
        collect(dt, sent[0], v, x)
        clock[1] += dt
    for k in range(delay):
        for j in range(n):
            sent[k, j] = sent[k + 1, j]
    for j in range(n):
        sent[delay, j] = tau[j]
    duration = clock[2]
    if duration > 0.0:
        if phase == 0:
            absorb(duration, regressor, bodies, tool, x, Y, clock[6])
            drift(duration, x, b, P)
        else:
            first = (n * (phase - 1)) // (WINDOW - 1)
            last = (n * phase) // (WINDOW - 1)
            for j in range(first, last):
                take_row(j, duration, x, Y, b, P, belief_table[7])
        if phase == WINDOW - 1:
            keep_possible(b, P)
    if phase == WINDOW - 1:
        close_window(clock[1], v, x)
        clock[2] = clock[1]
        clock[1] = 0.0
    trust(dt, n, clock[4], clock[5], b, P)
    link = (ticks - ticks // WINDOW) % n  # None in the tick that evaluates the regressor.
    body(link, n, tool, bodies[n + 4], bodies, b.used, dynamic)
    clock[0] += 1.0
