"""Names for the numbers of a task: one table as wide as the arm, and one as a twist.

Each array that crosses into a kernel costs time, so that all numbers of the joints, matrices
included, are rows of one table (rows, nv), and all others of another (rows, 6). The first holds
`Joints`, `PointRows` of `feasible`, the matrices and `GoalRows` of `nearest`; the second
`ToolRows`, `Numbers`, which have a row each, and scratch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from fotsmc_pin.control.rows import Joints

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class PointRows(NamedTuple):
    """Rows (nv,) of the point that leads.

    Attributes:
        v: its speed [rad/s].
        a: its acceleration [rad/s²].
        last_a: that of the last tick [rad/s²].
        move: what it moves in this tick [rad].
        away: how far it is from the posture that is wanted [rad].
        livest: acceleration that an approach may ask for [rad/s²].
        fastest: velocity limit [rad/s].
        lower: lowest position [rad].
        upper: highest position [rad].
        rising: speed that it takes on to close what is open [rad/s].
        asked: scratch, then the speed that it takes on.
        free: scratch.
        open: share by which the task moves a joint: 1, falling to 0 before its end.
        position: of each joint; 0 where it turns without end [rad].
    """

    v: Array
    a: Array
    last_a: Array
    move: Array
    away: Array
    livest: Array
    fastest: Array
    lower: Array
    upper: Array
    rising: Array
    asked: Array
    free: Array
    open: Array
    position: Array


class GoalRows(NamedTuple):
    """Rows (nv,) of the approach to a far goal.

    Attributes:
        step: to where the tool is nearest to the goal [rad].
        slope: of the squared error [m²/rad].
        lower: least step [rad].
        upper: largest step [rad].
        held: 1 or -1 where a joint is held at its largest or least step, else 0.
        lead: speed that follows a goal which moves [rad/s].
        lead_rate: acceleration that does [rad/s²].
    """

    step: Array
    slope: Array
    lower: Array
    upper: Array
    held: Array
    lead: Array
    lead_rate: Array


class ToolRows(NamedTuple):
    """Rows of six numbers about the tool, of which errors use the first `m`.

    Attributes:
        V_d: twist that is asked for, in the axes of the asked pose.
        A_d: its derivative.
        V: twist of the tool, in its own axes.
        bias: `J̇ v`.
        V_t: twist of the point's tool, in its own axes.
        bias_t: `J̇ v` there.
        A_t: derivative of `V_t`.
        led: twist of the reference, carried to the tool.
        led_rate: its derivative.
        nu: twist of the tool against the reference.
        e: error.
        e_dot: its rate.
        beta: what accelerates the error while the joints do not.
        given_up: error of the point's tool from what is asked.
        error: error of the tool from what is asked.
        scale: factors that make each direction a way.
        x: scratch.
        f: scratch.
    """

    V_d: Array
    A_d: Array
    V: Array
    bias: Array
    V_t: Array
    bias_t: Array
    A_t: Array
    led: Array
    led_rate: Array
    nu: Array
    e: Array
    e_dot: Array
    beta: Array
    given_up: Array
    error: Array
    scale: Array
    x: Array
    f: Array


class Numbers(NamedTuple):
    """Single numbers of a task, each in a row of its own.

    Attributes:
        rate: `ω`, at which the point closes its error [1/s].
        posture_rate: `ω_p` [1/s].
        threshold: `σ_0` [m].
        kept: smallest share of a direction that the law keeps.
        kept_t: the same of the point.
        has_say: 1 where posture has a say: of redundant arms, and where a direction is given up;
            `BEGINS` in the tick before, in which its law is to forget what was long ago.
        begun: whether there was a tick.
    """

    rate: Array
    posture_rate: Array
    threshold: Array
    kept: Array
    kept_t: Array
    has_say: Array
    begun: Array


BEGINS = -1.0
"""Mark of the tick before posture has a say."""
SIX = 6
"""Directions of a pose."""
POINT = len(Joints._fields)
"""First row of the point in the table of the joints."""
JACOBIAN = POINT + len(PointRows._fields)
"""First row of the tool's Jacobian there."""
JACOBIAN_T = JACOBIAN + SIX
"""First row of that of the point's tool."""
TASK = JACOBIAN_T + SIX
"""First row of `Je`, the Jacobian of the error."""
OPEN = TASK + SIX
"""First row of the same with the shares of `open_joints`."""
FACTOR = OPEN + SIX
"""First row of `L`, followed by `Y`, `Y_t` and three of scratch, (nv, nv) each, and `GoalRows`."""
NUMBERS = len(ToolRows._fields)
"""First row of the numbers in the table of the tool."""
SCRATCH = NUMBERS + len(Numbers._fields)
"""First row of the scratch there."""
ROOM = 8 * SIX
"""Rows of scratch."""


def rows_of_joints(nv: int) -> int:
    """Return how many rows the table of the joints has."""
    return FACTOR + 6 * nv + len(GoalRows._fields)
