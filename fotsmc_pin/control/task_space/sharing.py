"""The torque of a task: how the law and the posture's law share it, and what each is told of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import Joints, NoRows, named_rows, rows
from fotsmc_pin.control.task_space.tool_rows import (
    FACTOR,
    NUMBERS,
    OPEN,
    POINT,
    TASK,
    Numbers,
    PointRows,
    ToolRows,
)

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@kernel
def felt_at_tool(torque: Array, L: Array, Y: Array, m: int, felt: Array) -> None:
    """Write the acceleration `Je M⁻¹ τ = Yᵀ L⁻¹ τ` (m,) that a torque (nv,) is at the tool.

    Args:
        torque: `τ` (nv,), which becomes `L⁻¹ τ`.
        L: Cholesky factor of the mass matrix, as `factor` writes it (nv, nv).
        Y: `L⁻¹ Jeᵀ` in its first `m` columns (nv, nv).
        m: number of directions.
        felt: the acceleration, overwritten; entries beyond the m-th are left.
    """
    for a in range(m):
        felt[a] = 0.0
    for i in range(torque.size):
        entry = torque[i]
        for k in range(i):
            entry -= L[i, k] * torque[k]
        torque[i] = entry * L[i, i]
        for a in range(m):
            felt[a] += Y[i, a] * torque[i]


@kernel
def act(law: Array, posture: Array, h0: Array, joints: Array, tool: Array, Lambda: Array) -> bool:
    """Write the torque within the limits.

        τ = τ_p + κ Jeᵀ (F - J̄ᵀ (τ_p - C0 v - G0))

    with the smallest share `κ` of a direction that is kept; `τ_p = C0 v + G0` where posture has no
    say.

    Args:
        law: table of the law, whose torque is `F` (m,).
        posture: table of the posture's law, whose torque is `τ_p` (nv,).
        h0: `C0 v + G0` (nv,).
        joints: table of the joints; `p.asked` becomes `τ_p`.
        tool: table of the tool; `t.f` becomes `F`.
        Lambda: of the task.

    Returns:
        Whether a limit cut in.
    """
    x, p = named_rows(joints, Joints), named_rows(joints[POINT:], PointRows)
    t, b = named_rows(tool, ToolRows), named_rows(tool[NUMBERS:], Numbers)
    own = rows(law, Gains, NoRows, NoRows)[0]
    other = rows(posture, Gains, NoRows, NoRows)[0]
    m, n = Lambda.shape[0], joints.shape[1]
    Je, L, Y = joints[TASK:OPEN], joints[FACTOR : FACTOR + n], joints[FACTOR + n : FACTOR + 2 * n]
    # Je M⁻¹ (τ_p - h0) = Yᵀ L⁻¹ (τ_p - h0)
    for i in range(n):
        p.asked[i] = other.tau[i] if b.has_say[0] > 0.0 else h0[i]
        p.free[i] = p.asked[i] - h0[i]
    felt_at_tool(p.free, L, Y, m, t.f)
    for i in range(m):
        t.x[i] = own.tau[i]
        for k in range(m):
            t.x[i] -= Lambda[i, k] * t.f[k]
        t.x[i] *= b.kept[0]
    is_limited = False
    for i in range(n):
        wanted = p.asked[i]
        for k in range(m):
            wanted += Je[k, i] * t.x[k]
        x.tau[i] = clip(wanted, x.effort_limit[i])
        is_limited = is_limited or x.tau[i] != wanted
    for i in range(m):
        t.f[i] = own.tau[i]
    return is_limited


@kernel
def tell(law: Array, posture: Array, h0: Array, joints: Array, tool: Array, Lambda: Array) -> None:
    """Tell both laws what acts beyond the torque that they asked for.

    A law takes for a disturbance what another does, or a limit takes away, and works against it:
    two that integrate side by side would drift apart without end. With the torque `τ` that acts,
    they are told

        Λ Je M⁻¹ (τ - C0 v - G0) - F   at the tool,   τ - τ_p   at the joints.

    Args:
        law: table of the law.
        posture: table of the posture's law.
        h0: `C0 v + G0` (nv,).
        joints: table of the joints, with the torque `τ`, and in `p.asked` that of posture, `τ_p`.
        tool: table of the tool, with `F` in `t.f`.
        Lambda: of the task.
    """
    x, p = named_rows(joints, Joints), named_rows(joints[POINT:], PointRows)
    t = named_rows(tool, ToolRows)
    own = rows(law, Gains, NoRows, NoRows)[0]
    other = rows(posture, Gains, NoRows, NoRows)[0]
    m, n = Lambda.shape[0], joints.shape[1]
    L, Y = joints[FACTOR : FACTOR + n], joints[FACTOR + n : FACTOR + 2 * n]
    for i in range(n):
        other.tau[i] = x.tau[i]
        other.tau_extra[i] = x.tau[i] - p.asked[i]
        p.free[i] = x.tau[i] - h0[i]
    felt_at_tool(p.free, L, Y, m, t.x)
    for i in range(m):
        own.tau[i] = 0.0
        for k in range(m):
            own.tau[i] += Lambda[i, k] * t.x[k]
        own.tau_extra[i] = own.tau[i] - t.f[i]
