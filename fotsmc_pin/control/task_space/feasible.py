"""The feasible reference: a motion of the joints that brings the tool where it is asked to be.

What is asked of the tool may not be possible: at the start the tool is elsewhere, at a singularity
it cannot move in one direction, and joints have ends and speed limits. So a point in the space of
joints, without mass, goes where the tool is asked to be as far as it can: it tracks what is near,
and approaches what is far (`nearest`). The law follows where this point has the tool; what lies
between the two is what was given up.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.task_space.mobility import to_joints
from fotsmc_pin.control.task_space.nearest import TRUST

if TYPE_CHECKING:
    from fotsmc_pin.control.task_space.tool_rows import GoalRows, PointRows
    from fotsmc_pin.types import Array

APPROACH = 0.5
"""Share of the joints' velocity limits at which a far goal is approached."""
FASTEST = 0.95
"""Share of them that the point never exceeds."""
BRAKING, LIVELIEST = 0.3, 4.0
"""Share of the effort limit over the joint's inertia that an approach may ask for, as an
acceleration; and the most that it asks for [rad/s², m/s²]."""
VIOLENT, JERK = 5.0, 100.0
"""Acceleration over that of an approach which the point never exceeds, and the most by which it
changes in a second, so that no torque jumps [1/s]."""
MARGIN, SHARE = 0.2, 0.1
"""Room before a joint's end in which posture moves away from it [rad, m]; and the share of the
joint's range that it is at most."""
REPULSION, CALMING = 50.0, 14.0
"""Acceleration per room that is missing [1/s²], and damping of a joint that has none left [1/s]."""
CLOSED = 0.25
"""Room over the margin at which the task no longer moves a joint."""
NEAR, FAR = 0.5, 1.0
"""Error over `σ_0` up to which a goal is tracked, and from which on it is approached; twice that
counts as one that is not reached."""


@kernel(is_part=True)
def open_joints(p: PointRows, m: int, J: Array, J_open: Array) -> None:
    """Write the share by which each joint takes part, and the Jacobian with these shares.

    It goes from 1 where a joint has `MARGIN` of room to 0 where it has a quarter of that: what the
    joint would have done is done by others, or given up as at a singularity.
    """
    for j in range(p.v.size):
        margin = min(MARGIN, SHARE * (p.upper[j] - p.lower[j]))
        room = min(p.position[j] - p.lower[j], p.upper[j] - p.position[j])
        u = min(max((room / margin - CLOSED) / (1.0 - CLOSED), 0.0), 1.0)
        p.open[j] = u * u * (3.0 - 2.0 * u)
        for i in range(m):
            J_open[i, j] = p.open[j] * J[i, j]


@kernel(is_part=True)
def bound_steps(p: PointRows, g: GoalRows) -> None:
    """Write the bounds of a step: the ends, less where `open_joints` closes, within `TRUST`."""
    for j in range(p.v.size):
        closed = CLOSED * min(MARGIN, SHARE * (p.upper[j] - p.lower[j]))
        g.upper[j] = min(p.upper[j] - closed - p.position[j], TRUST)
        g.lower[j] = max(p.lower[j] + closed - p.position[j], -TRUST)


@kernel(is_part=True)
def track(
    rate: float, posture_rate: float, m: int, p: PointRows,
    J: Array, L: Array, Y: Array, Lambda: Array,
    e: Array, e_dot: Array, beta: Array, x: Array, f: Array, lost: float,
) -> None:  # fmt: skip
    """Choose the acceleration of the point that tracks what is asked of the tool.

    With the error `e` of its tool from what is asked, which moves with `ë = J a + β`, and
    the damped inverse `J̄`, to whose rows the shares of `open_joints` belong,

        a = J̄ (-2ω (ė + r ω/2 e) - β) + (1 - J̄ J) a_p
        a_p = -ω_p² (q ⊖ q_p) - 2 ω_p v - ω l v + repulsion of joint ends

    `r ≤ 1` slows a far approach so that every joint keeps to half of its velocity limit, and can
    stop in time with 0.3 of its effort limit. What pulls the point to where it cannot go is a
    spring about a singularity that nothing damps: `l ≤ 1` does, where directions are given up and
    the goal is not near.
    """
    n = p.v.size
    # The approach: r
    to_joints(L, Y, Lambda, m, e, p.rising, f)
    r = 1.0
    position = p.position
    for j in range(n):
        p.rising[j] *= p.open[j]
        way = abs(p.rising[j])
        if way > 0.0:
            most = min(APPROACH * p.fastest[j], math.sqrt(p.livest[j] * way))
            r = min(r, 2.0 * most / (rate * way))
    for i in range(m):
        x[i] = -2.0 * rate * (e_dot[i] + 0.5 * r * rate * e[i])
    to_joints(L, Y, Lambda, m, x, p.asked, f)
    share = 1.0
    for j in range(n):
        share = min(share, p.livest[j] / max(abs(p.open[j] * p.asked[j]), 1e-12))
    for i in range(m):
        x[i] = share * x[i] - beta[i]
    # Posture, in what the task leaves
    size = 0.0
    for j in range(n):
        p.free[j] = -posture_rate * (posture_rate * p.away[j] + 2.0 * p.v[j])
        size = max(size, abs(p.free[j]) / p.livest[j])
    for j in range(n):
        p.free[j] = p.free[j] / max(size, 1.0) - rate * lost * p.v[j]
        p.free[j] -= CALMING * (1.0 - p.open[j]) * p.v[j]
        margin = min(MARGIN, SHARE * (p.upper[j] - p.lower[j]))
        p.free[j] += REPULSION * max(margin - (position[j] - p.lower[j]), 0.0)
        p.free[j] -= REPULSION * max(margin - (p.upper[j] - position[j]), 0.0)
    for i in range(m):
        for j in range(n):
            x[i] -= J[i, j] * p.free[j]
    to_joints(L, Y, Lambda, m, x, p.a, f)
    for j in range(n):
        p.a[j] = p.open[j] * p.a[j] + p.free[j]


@kernel(is_part=True)
def move_point(dt: float, p: PointRows, is_one: bool) -> None:
    """Move the point's speed by one tick, within speed, acceleration and its rate.

    What a joint's speed exceeds slows all joints alike, so that the direction of the motion stays.
    So does what its acceleration exceeds, and what exceeds the change of that, 100 times that of an
    approach in a second, where the joints act as one, to move the tool. On the way to a far goal
    each keeps to its own: one that starts must not take the brake from one that stops.
    """
    n, position = p.v.size, p.position
    share, slower = 1.0, 1.0
    for j in range(n):
        share = min(share, VIOLENT * p.livest[j] / max(abs(p.a[j]), 1e-12))
    for j in range(n):
        own = VIOLENT * p.livest[j] / max(abs(p.a[j]), 1e-12)
        p.asked[j] = p.v[j] + dt * (share if is_one else min(own, 1.0)) * p.a[j]
        slower = min(slower, FASTEST * p.fastest[j] / max(abs(p.asked[j]), 1e-12))
    share = 1.0
    for j in range(n):
        wanted = slower * p.asked[j]
        up = math.sqrt(2.0 * p.livest[j] * max(p.upper[j] - position[j], 0.0))
        down = math.sqrt(2.0 * p.livest[j] * max(position[j] - p.lower[j], 0.0))
        wanted = min(max(wanted, -down), up)
        p.a[j] = (wanted - p.v[j]) / dt
        change = abs(p.a[j] - p.last_a[j])
        share = min(share, JERK * dt * p.livest[j] / max(change, 1e-12))
    for j in range(n):
        change = p.a[j] - p.last_a[j]
        own = JERK * dt * p.livest[j] / max(abs(change), 1e-12)
        p.a[j] = p.last_a[j] + (share if is_one else min(own, 1.0)) * change
        p.last_a[j] = p.a[j]
        p.asked[j] = p.v[j] + dt * p.a[j]
        p.move[j] = 0.5 * dt * (p.v[j] + p.asked[j])
