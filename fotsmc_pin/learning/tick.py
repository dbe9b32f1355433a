"""One tick of learning: the pieces of the estimator, spread so that no tick is much longer."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.learning.change import notice_change
from fotsmc_pin.learning.estimator import (
    ROUND,
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
from fotsmc_pin.learning.trust import body, help_start, trust, turn_friction

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class Whole(NamedTuple):
    """Numbers of the whole arm, each a vector (1,).

    Attributes:
        ticks: how many there were.
        elapsed: since the window began [s].
        duration: of the last window [s]; 0 before there was one.
        settled: since the last change [s].
        changes: how many were noticed.
        lowest: ratio of true to believed inertia down to which the loop is used.
        highest: the same, upward.
        fall: speed at which friction falls [rad/s, m/s].
        tool: index of the link that carries the tool.
    """

    ticks: Array
    elapsed: Array
    duration: Array
    settled: Array
    changes: Array
    lowest: Array
    highest: Array
    fall: Array
    tool: Array


@kernel(rounds_freely=True)
def learn(
    dt: float,
    tau: Array,
    v: Array,
    v_d: Array,
    whole: Array,
    sent: Array,
    joints: Array,
    beliefs: Array,
    P: Array,
    Y: Array,
    regressor: Array,
    bodies: Array,
    written: Array,
) -> None:
    """Learn from one tick, and write the dynamic parameters of one link.

    Args:
        dt: time since the last tick [s].
        tau: torque that was just sent (nv,).
        v: measured speed (nv,).
        v_d: wanted speed (nv,).
        whole: rows of `Whole` (9, 1).
        sent: torques that were sent and did not act yet, the oldest first (delay + 1, nv); moved on
            by one.
        joints: rows of `JointRows` (19, nv).
        beliefs: rows of `Beliefs` (8, p).
        P: covariance (p, p).
        Y: rows after one and after both low-passes (2, nv, c).
        regressor: Pinocchio's of the last window, new in the first tick of each (nv, 10 nv).
        bodies: dynamic parameters per unit of each shared column, and in the last row the tool's
            place (4 nv + 5, 10).
        written: dynamic parameters of the learnt links (nv, 10); a row is written anew, another one
            in each tick but a window's first.
    """
    n, delay = v.size, sent.shape[0] - 1
    a = named_rows(whole, Whole)
    x = named_rows(joints, JointRows)
    b = named_rows(beliefs, Beliefs)
    ticks, tool, duration = int(a.ticks[0]), int(a.tool[0]), a.duration[0]
    phase = ticks % WINDOW

    # What acted since the last tick, and what will.
    if ticks > 0:
        collect(dt, sent[0], v, x)
        a.elapsed[0] += dt
    for j in range(n):
        for k in range(delay):
            sent[k, j] = sent[k + 1, j]
        sent[delay, j] = tau[j]

    # The first tick of a window takes in the last one; the others a share of the joints each.
    if duration > 0.0 and phase == 0:
        absorb(duration, regressor, bodies, tool, x, Y, a.fall[0])
        drift(duration, x, b, P)
        a.settled[0] += duration
        if notice_change(a.settled[0], x, Y, b, P):
            a.settled[0], a.changes[0] = 0.0, a.changes[0] + 1.0
    elif duration > 0.0:
        shares, part = ROUND * (WINDOW - 1), ticks // WINDOW % ROUND * (WINDOW - 1) + phase
        for j in range((n * (part - 1)) // shares, (n * part) // shares):
            take_row(j, ROUND * duration, x, Y[1], b, P)
        keep_possible(b, P)
    if phase == WINDOW - 1:
        close_window(a.elapsed[0], v, x)
        a.duration[0], a.elapsed[0] = a.elapsed[0], 0.0

    trust(dt, n, a.lowest[0], a.highest[0], x, b, P)
    help_start(dt, v_d, x, b)
    turn_friction(dt, v_d, x)
    if phase > 0:
        link = (ticks - ticks // WINDOW) % n
        body(link, n, tool, bodies, b.used, written[link])
    a.ticks[0] += 1.0
