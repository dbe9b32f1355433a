"""One tick of a task: from the arm and what is asked of the tool to what the law sees, and back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.compiled import call, kernel
from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import Joints, NoRows, named_rows, rows
from fotsmc_pin.control.task_space.chain import chain_motion
from fotsmc_pin.control.task_space.compare import carry, error_rate, rate_of_error, times_jacobian
from fotsmc_pin.control.task_space.configurations import difference, step
from fotsmc_pin.control.task_space.feasible import (
    APPROACH,
    BRAKING,
    FAR,
    LIVELIEST,
    NEAR,
    bound_steps,
    move_point,
    open_joints,
    track,
)
from fotsmc_pin.control.task_space.mobility import factor, task_inertia
from fotsmc_pin.control.task_space.nearest import approach, step_to_nearest, weigh
from fotsmc_pin.control.task_space.pose_log import error_of
from fotsmc_pin.control.task_space.sharing import act, tell
from fotsmc_pin.control.task_space.tool_rows import (
    BEGINS,
    FACTOR,
    JACOBIAN,
    JACOBIAN_T,
    NUMBERS,
    OPEN,
    POINT,
    SCRATCH,
    SIX,
    TASK,
    GoalRows,
    Numbers,
    PointRows,
    ToolRows,
)
from fotsmc_pin.control.task_space.twists import quaternion, seen_from

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array


@kernel
def see(
    dt: float, M0: Array, joints: Array, tool: Array, configurations: Array,
    poses: Array, quaternions: Array,
    chain: NDArray[np.int64], places: NDArray[np.int64], kind: NDArray[np.int64],
    posture: Array, table: Array, Lambda: Array, h: Array,
) -> None:  # fmt: skip
    """Move the point and write what the law is to see: a mechanical system of `m` directions.

    The law's `M0` is `Λ`, its position error the error of the tool from the point's tool, its
    speed `E V`, its reference's acceleration `d/dt (E V_l)`, its own

        d/dt (E V) = Λ⁻¹ F + E J̇ v + Ė V,   so that   h = -Λ (E J̇ v + Ė V)

    where the joints' `C0 v + G0` are already made up for. Its reference's speed, by which laws tell
    rest, is that of the fastest joint of the point in every direction: what sticks is joints, and
    no direction is at rest while one of them is to move.
    """
    x, p = named_rows(joints, Joints), named_rows(joints[POINT:], PointRows)
    t, b = named_rows(tool, ToolRows), named_rows(tool[NUMBERS:], Numbers)
    seen = rows(table, Gains, NoRows, NoRows)[0]
    q, q_t, q_p = configurations[0], configurations[1], configurations[2]
    pose_d, pose, pose_t, X, rigid = poses[0], poses[1], poses[2], poses[3], poses[4:]
    m, n = Lambda.shape[0], joints.shape[1]
    J, J_t = joints[JACOBIAN:JACOBIAN_T], joints[JACOBIAN_T:TASK]
    Je, J_open = joints[TASK:OPEN], joints[OPEN:FACTOR]
    L, Y, Y_t = joints[FACTOR:], joints[FACTOR + n :], joints[FACTOR + 2 * n :]
    L, Y, Y_t = L[:n], Y[:n], Y_t[:n]
    H, C, K = joints[FACTOR + 3 * n :], joints[FACTOR + 4 * n :], joints[FACTOR + 5 * n :]
    H, C, K = H[:n], C[:n], K[:n]
    g = named_rows(joints[FACTOR + 6 * n :], GoalRows)
    work = tool[SCRATCH:]
    E, s, W = work[:SIX], work[2 * SIX :], work[7 * SIX :]
    chain_motion(chain, rigid, q, x.v, pose, J, t.V, t.bias)
    chain_motion(chain, rigid, q_t, p.v, pose_t, J_t, t.V_t, t.bias_t)
    factor(M0, n, L)

    # The point, and what it gives up
    seen_from(pose_d, pose_t, X)
    error_of(X[:3], X[3, :3], kind, t.given_up[:m], E[:m], s)
    carry(X, t.V_t, t.V_d, t.A_d, t)
    is_small = rate_of_error(X, t.nu, t.given_up, kind, m, t.e_dot, work)
    error_rate(is_small, t.given_up, t.e_dot, t.nu, m, t.beta, work)
    for i in range(m):
        for j in range(SIX):
            t.beta[i] += E[i, j] * (t.bias_t[j] - t.led_rate[j])
    times_jacobian(E, J_t, m, Je)
    difference(q_p, q_t, places, p.away)
    for j in range(n):
        k = places[0, j]
        p.position[j] = q_t[k] if places[1, j] == 1 else 0.0
        p.livest[j] = min(BRAKING * x.effort_limit[j] / M0[j, j], LIVELIEST)
    open_joints(p, m, Je, J_open)
    b.kept_t[0] = task_inertia(J_open, L, m, t.scale, b.threshold[0], Y_t, Lambda, s)
    square = weigh(X, t.given_up, E, kind, m, t.scale, W, t.f)
    far = math.sqrt(square) / b.threshold[0]
    share = min(max((far - NEAR) / (FAR - NEAR), 0.0), 1.0)
    if share > 0.0:
        bound_steps(p, g)
        for i in range(SIX):
            t.x[i] = t.bias_t[i] - t.led_rate[i]
        step_to_nearest(
            g, p, chain, J_t, M0, W, t.f, square, t.led, t.x, b.threshold[0],
            b.posture_rate[0] / b.rate[0], H, C, K,
        )  # fmt: skip
    if share < 1.0:
        lost = (1.0 - b.kept_t[0]) * min(far / (2.0 * FAR), 1.0)
        track(
            b.rate[0], b.posture_rate[0], m, p, Je, L, Y_t, Lambda, t.given_up, t.e_dot, t.beta,
            t.x, t.f, lost,
        )  # fmt: skip
    if share > 0.0:
        follow = 1.0 / (1.0 + 0.25 * (far / FAR) ** 2)
        approach(g, p, b.rate[0], share, follow, APPROACH)
    move_point(dt, p, share < 1.0)
    for i in range(SIX):
        t.A_t[i] = t.bias_t[i]
        for c in range(n):
            t.A_t[i] += J_t[i, c] * p.a[c]

    # The tool, from what is asked, and from where the point has it
    seen_from(pose_d, pose, X)
    error_of(X[:3], X[3, :3], kind, t.error[:m], E[:m], s)
    seen_from(pose_t, pose, X)
    error_of(X[:3], X[3, :3], kind, t.e[:m], E[:m], s)
    carry(X, t.V, t.V_t, t.A_t, t)
    is_small = rate_of_error(X, t.nu, t.e, kind, m, t.e_dot, work)
    error_rate(is_small, t.e, t.e_dot, t.led, m, t.f, work)
    error_rate(is_small, t.e, t.e_dot, t.V, m, t.x, work)
    fastest = 0.0
    for j in range(n):
        fastest = max(fastest, abs(p.v[j]))
    for i in range(m):
        seen.e[i], seen.e_dot[i], seen.v_d[i] = t.e[i], t.e_dot[i], fastest
        speed, wanted, own = 0.0, t.f[i], t.x[i]
        for j in range(SIX):
            speed += E[i, j] * t.V[j]
            wanted += E[i, j] * t.led_rate[j]
            own += E[i, j] * t.bias[j]
        seen.v[i], seen.a_d[i], t.x[i] = speed, wanted, own
    times_jacobian(E, J, m, Je)
    b.kept[0] = task_inertia(Je, L, m, t.scale, b.threshold[0], Y, Lambda, s)
    for i in range(m):
        h[i] = 0.0
        for j in range(m):
            h[i] -= Lambda[i, j] * t.x[j]

    # What posture sees, and what a recording and a model that is learnt do: the joints
    difference(q_t, q, places, x.e)
    own_rows = rows(posture, Gains, NoRows, NoRows)[0]
    for j in range(n):
        x.v_d[j] = own_rows.v_d[j] = p.v[j]
        x.a_d[j] = own_rows.a_d[j] = p.a[j]
        x.e_dot[j] = own_rows.e_dot[j] = x.v[j] - p.v[j]
        own_rows.e[j], own_rows.v[j] = x.e[j], x.v[j]
        p.v[j] = p.asked[j]
    for k in range(q_t.size):
        configurations[3, k] = q_t[k]
    step(q_t, places, p.move)
    b.begun[0] = 1.0
    quaternion(pose, quaternions[0])
    quaternion(pose_d, quaternions[1])
    quaternion(pose_t, quaternions[2])
    if n == m and b.kept[0] == 1.0:
        b.has_say[0] = 0.0
    elif b.has_say[0] == 0.0:
        b.has_say[0] = 1.0 if n > m else BEGINS


@kernel
def tick(
    dt: float, law: Any, own: Any, posture_law: Any, posture: Any, joints: Array, tool: Array,
    configurations: Array, poses: Array, quaternions: Array,
    chain: NDArray[np.int64], places: NDArray[np.int64], kind: NDArray[np.int64],
) -> None:  # fmt: skip
    """Run the whole tick: see, let the law and the posture's law act, write the torque.

    Args:
        dt: time since the last tick [s].
        law: address of the law's tick.
        own: what that takes after `dt`: its table, `Λ`, `h` and its streams.
        posture_law: address of the posture's law.
        posture: what that takes: its table, `M0`, `C0 v + G0` and its streams.
        joints: table of the joints.
        tool: table of the tool.
        configurations: of arm, point, posture, and the point's as it was in this tick (4, nq).
        poses: asked for, of the tool, of the point's tool, scratch, and the rigid parts of the
            chain (4 + k + 1, 4, 3).
        quaternions: poses as they are shown (3, 7).
        chain: joints that carry the tool (k, 3).
        places: of the joints in `q` (2, nv).
        kind: of the error (6,).
    """
    table, Lambda, h = own[0], own[1], own[2]
    others, M0, h0 = posture[0], posture[1], posture[2]
    see(
        dt, M0, joints, tool, configurations, poses, quaternions, chain, places, kind,
        others, table, Lambda, h,
    )  # fmt: skip
    b = named_rows(tool[NUMBERS:], Numbers)
    if b.has_say[0] > 0.0:
        call(posture_law, dt, posture)
    call(law, dt, own)
    is_limited = act(table, others, h0, joints, tool, Lambda)
    tell(table, others, h0, joints, tool, Lambda)
    if b.kept[0] == 1.0 and not is_limited:  # All but rounding is the law's own.
        for i in range(h.size):
            rows(table, Gains, NoRows, NoRows)[0].tau_extra[i] = 0.0
