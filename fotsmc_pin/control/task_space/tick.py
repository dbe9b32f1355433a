"""One tick of a task: from the arm and what is asked of the tool to what the law sees, and back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import Joints, NoRows, named_rows, rows
from fotsmc_pin.control.task_space.configurations import difference, step
from fotsmc_pin.control.task_space.feasible import (
    BRAKING,
    LIVELIEST,
    PointRows,
    lead_point,
    open_joints,
)
from fotsmc_pin.control.task_space.mobility import factor, task_inertia
from fotsmc_pin.control.task_space.pose_log import (
    NEARBY,
    error_of,
    rate_of_rate,
    small_rate_of_rate,
)
from fotsmc_pin.control.task_space.tool_motion import (
    carried,
    quaternion,
    seen_from,
    tool_motion,
    twist_cross,
)
from fotsmc_pin.control.task_space.tool_rows import Numbers, ToolRows

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array


FAR = 2.0
"""Error over `σ_0` from which on a goal counts as one that is not reached."""


@kernel(is_part=True)
def compare(
    X: Array, V: Array, V_ref: Array, A_ref: Array, kind: NDArray[np.int64], m: int,
    t: ToolRows, e: Array, E: Array, E_dot: Array, s: Array,
) -> None:  # fmt: skip
    """Write the error of a pose against a reference, `E`, `Ė`, and the reference as it is carried.

    With `V_l = Ad(X)⁻¹ V_ref` and `ν = V - V_l`: `ė = E ν`, `V̇_l = Ad(X)⁻¹ A_ref - ν × V_l`.
    """
    error_of(X[:3], X[3, :3], kind, e[:m], E[:m], s)
    carried(X, V_ref, t.led)
    carried(X, A_ref, t.led_rate)
    for i in range(6):
        t.nu[i] = V[i] - t.led[i]
    twist_cross(t.nu, t.led, t.led_rate, s[0])
    square = 0.0
    for i in range(m):
        square += e[i] * e[i]
    if kind[0] == 1 and square < NEARBY * NEARBY:
        for i in range(6):
            t.x[i] = 0.0
            for j in range(6):
                t.x[i] += E[i, j] * t.nu[j]
        small_rate_of_rate(e, t.x, E_dot, s)
    else:
        rate_of_rate(X[:3], X[3, :3], t.nu, kind, E_dot[:m], s)


@kernel
def see(
    dt: float, turn: Array, place: Array, columns: Array, rates: Array,
    turn_t: Array, place_t: Array, columns_t: Array, rates_t: Array,
    M0: Array, configurations: Array, places: NDArray[np.int64], kind: NDArray[np.int64],
    joints: Array, point: Array, tool: Array, numbers: Array, poses: Array,
    Js: Array, L: Array, Ys: Array, squares: Array, scratch: Array,
    quaternions: Array, posture: Array, table: Array, Lambda: Array, h: Array,
) -> bool:  # fmt: skip
    """Move the point and write what the law is to see: a mechanical system of `m` directions.

    The law's `M0` is `Λ`, its position error the error of the tool from the point's tool, its
    speed `E V`, its reference's acceleration `d/dt (E V_l)`, its own

        d/dt (E V) = Λ⁻¹ F + E J̇ v + Ė V,   so that   h = -Λ (E J̇ v + Ė V)

    where the joints' `C0 v + G0` are already made up for. Its reference's speed, by which laws tell
    rest, is that of the fastest joint of the point in every direction: what sticks is joints, and
    no direction is at rest while one of them is to move. Returns whether posture has a say.
    """
    t, p, x = named_rows(tool, ToolRows), named_rows(point, PointRows), named_rows(joints, Joints)
    b, seen = named_rows(numbers, Numbers), rows(table, Gains, NoRows, NoRows)[0]
    q, q_t, q_p = configurations[0], configurations[1], configurations[2]
    m, n = Lambda.shape[0], L.shape[0]
    pose_d, pose, pose_t, X = poses[0], poses[1], poses[2], poses[3]
    J, J_t, Je = Js[0], Js[1], Js[2]
    E, E_dot, s = squares[0], squares[1], scratch
    mount, moves = poses[4], p.moves
    tool_motion(turn, place, columns, rates, mount, moves, x.v, pose, J, t.V, t.bias)
    tool_motion(
        turn_t, place_t, columns_t, rates_t, mount, moves, p.v, pose_t, J_t, t.V_t, t.bias_t
    )
    factor(M0, n, L)

    # The point, and what it gives up
    seen_from(pose_d, pose_t, X)
    compare(X, t.V_t, t.V_d, t.A_d, kind, m, t, t.given_up, E, E_dot, s)
    for i in range(m):
        t.e_dot[i] = t.beta[i] = 0.0
        for j in range(6):
            t.e_dot[i] += E[i, j] * t.nu[j]
            t.beta[i] += E[i, j] * (t.bias_t[j] - t.led_rate[j]) + E_dot[i, j] * t.nu[j]
        for c in range(n):
            Je[i, c] = 0.0
            for j in range(6):
                Je[i, c] += E[i, j] * J_t[j, c]
    Y, work = Ys[0], squares[2:]
    difference(q_p, q_t, places, p.away)
    for j in range(n):
        k = places[0, j]
        p.position[j] = q_t[k] if places[1, j] == 1 else 0.0
        p.livest[j] = min(BRAKING * x.effort_limit[j] / M0[j, j], LIVELIEST)
    open_joints(p, m, Je, Js[3])
    b.kept_t[0] = task_inertia(Js[3], L, m, t.scale, b.threshold[0], Y, Lambda, work)
    far = 0.0
    for i in range(m):
        far += (t.scale[i] * t.given_up[i]) ** 2
    lost = (1.0 - b.kept_t[0]) * min(math.sqrt(far) / (FAR * b.threshold[0]), 1.0)
    lead_point(
        dt, b.rate[0], b.posture_rate[0], m, p, Je, L, Y, Lambda, t.given_up, t.e_dot, t.beta,
        t.x, t.f, lost,
    )  # fmt: skip
    for i in range(6):
        t.A_t[i] = t.bias_t[i]
        for c in range(n):
            t.A_t[i] += J_t[i, c] * p.a[c]

    # The tool, from what is asked, and from where the point has it
    seen_from(pose_d, pose, X)
    error_of(X[:3], X[3, :3], kind, t.error[:m], E[:m], s)
    seen_from(pose_t, pose, X)
    compare(X, t.V, t.V_t, t.A_t, kind, m, t, t.e, E, E_dot, s)
    fastest = 0.0
    for j in range(n):
        fastest = max(fastest, abs(p.v[j]))
    for i in range(m):
        seen.e[i], seen.v_d[i] = t.e[i], fastest
        seen.e_dot[i] = seen.v[i] = seen.a_d[i] = t.x[i] = 0.0
        for j in range(6):
            seen.e_dot[i] += E[i, j] * t.nu[j]
            seen.v[i] += E[i, j] * t.V[j]
            seen.a_d[i] += E[i, j] * t.led_rate[j] + E_dot[i, j] * t.led[j]
            t.x[i] -= E[i, j] * t.bias[j] + E_dot[i, j] * t.V[j]
        for c in range(n):
            Je[i, c] = 0.0
            for j in range(6):
                Je[i, c] += E[i, j] * J[j, c]
    b.kept[0] = task_inertia(Je, L, m, t.scale, b.threshold[0], Ys[1], Lambda, work)
    for i in range(m):
        h[i] = 0.0
        for j in range(m):
            h[i] += Lambda[i, j] * t.x[j]

    # What posture sees, and what a recording and a model that is learnt do: the joints
    difference(q_t, q, places, x.e)
    for j in range(n):
        x.v_d[j], x.a_d[j] = p.v[j], p.a[j]
        x.e_dot[j] = x.v[j] - p.v[j]
    own = rows(posture, Gains, NoRows, NoRows)[0]
    for j in range(n):
        own.e[j], own.e_dot[j], own.v[j] = x.e[j], x.e_dot[j], x.v[j]
        own.v_d[j], own.a_d[j] = x.v_d[j], x.a_d[j]
    configurations[3] = q_t
    p.v[:] = p.asked
    step(q_t, places, p.move)
    b.begun[0] = 1.0
    quaternion(pose, quaternions[0])
    quaternion(pose_d, quaternions[1])
    quaternion(pose_t, quaternions[2])
    return bool(n > m or b.kept[0] < 1.0)


@kernel(is_part=True)
def felt_at_tool(torque: Array, L: Array, Y: Array, felt: Array) -> None:
    """Write the acceleration `Je M⁻¹ τ = Yᵀ L⁻¹ τ` (m,) that a torque (nv,) is at the tool.

    Args:
        torque: `τ` (nv,), which becomes `L⁻¹ τ`.
        L: Cholesky factor of the mass matrix (nv, nv).
        Y: `L⁻¹ Jeᵀ` (nv, m).
        felt: the acceleration, overwritten; entries beyond the m-th are left.
    """
    n, m = Y.shape
    for i in range(n):
        entry = torque[i]
        for k in range(i):
            entry -= L[i, k] * torque[k]
        torque[i] = entry / L[i, i]
    for a in range(m):
        felt[a] = 0.0
        for i in range(n):
            felt[a] += Y[i, a] * torque[i]


@kernel
def act(
    force: Array, posture: Array, h0: Array, joints: Array, point: Array, tool: Array,
    Js: Array, L: Array, Ys: Array, Lambda: Array,
) -> float:  # fmt: skip
    """Write the torque `τ = Jeᵀ F + C0 v + G0 + (1 - Jeᵀ J̄ᵀ)(τ_p - C0 v - G0)` within the limits.

    Args:
        force: the law's `F` (m,).
        posture: torque `τ_p` of the posture's law (nv,), or `C0 v + G0` where none acts.
        h0: `C0 v + G0` (nv,).
        joints: rows of the joints.
        point: rows of the point, as scratch.
        tool: rows of the tool, as scratch; `t.x` becomes the force that the limits leave.
        Js: Jacobians.
        L: Cholesky factor of the mass matrix.
        Ys: of the task.
        Lambda: of the task.

    Returns:
        Largest torque over its limit, before that is kept.
    """
    t, p, x = named_rows(tool, ToolRows), named_rows(point, PointRows), named_rows(joints, Joints)
    Je, Y = Js[2], Ys[1]
    m, n = Lambda.shape[0], L.shape[0]
    # Je M⁻¹ (τ_p - h0) = Yᵀ L⁻¹ (τ_p - h0)
    for i in range(n):
        p.free[i] = posture[i] - h0[i]
    felt_at_tool(p.free, L, Y, t.x)
    for a in range(m):
        t.f[a] = force[a]
        for b in range(m):
            t.f[a] -= Lambda[a, b] * t.x[b]
    most = 0.0
    for i in range(n):
        wanted = posture[i]
        for a in range(m):
            wanted += Je[a, i] * t.f[a]
        most = max(most, abs(wanted) / x.effort_limit[i])
        x.tau[i] = clip(wanted, x.effort_limit[i])
        p.free[i] = x.tau[i] - wanted
    # What the limits took from the force: Λ Yᵀ L⁻¹ (τ - τ_wanted)
    if most > 1.0:
        felt_at_tool(p.free, L, Y, t.f)
        for a in range(m):
            t.x[a] = force[a]
            for b in range(m):
                t.x[a] += Lambda[a, b] * t.f[b]
    return most
