"""How an error moves with the tool and its reference: the parts of a tick that both errors need."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.task_space.pose_log import (
    NEARBY,
    rate_of_rate,
    small_rate_of_rate,
    twist_product,
)
from fotsmc_pin.control.task_space.tool_rows import SIX
from fotsmc_pin.control.task_space.twists import carried

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fotsmc_pin.control.task_space.tool_rows import ToolRows
    from fotsmc_pin.types import Array


@kernel(is_part=True)
def carry(X: Array, V: Array, V_ref: Array, A_ref: Array, t: ToolRows) -> None:
    """Write the reference's motion as one of the tool, and the tool's against it.

    With the adjoint of the pose:

        V_l = Ad(X)⁻¹ V_ref,   ν = V - V_l,   V̇_l = Ad(X)⁻¹ A_ref - ν × V_l
    """
    carried(X, V_ref, t.led)
    carried(X, A_ref, t.led_rate)
    for i in range(SIX):
        t.nu[i] = V[i] - t.led[i]
    twist_product(t.nu, t.led, t.x)
    for i in range(SIX):
        t.led_rate[i] -= t.x[i]


@kernel
def rate_of_error(
    X: Array, nu: Array, e: Array, kind: NDArray[np.int64], m: int, e_dot: Array, work: Array
) -> bool:
    """Write `ė = E ν`, and where the error is not a small one of all directions, `Ė` too.

    Args:
        X: pose of the tool in its reference's (4, 3).
        nu: twist of the tool against its reference (6,).
        e: error (m,).
        kind: of the error.
        m: number of directions.
        e_dot: overwritten (6,).
        work: `E`, and `Ė`, which is overwritten, six rows each, and scratch.

    Returns:
        Whether the error is small and `Ė` has no need to be written.
    """
    square = 0.0
    for i in range(m):
        square += e[i] * e[i]
        e_dot[i] = 0.0
        for j in range(SIX):
            e_dot[i] += work[i, j] * nu[j]
    if kind[0] == 1 and square < NEARBY * NEARBY:
        return True
    rate_of_rate(X[:3], X[3, :3], nu, kind, work[SIX : SIX + m], work[2 * SIX :])
    return False


@kernel
def error_rate(
    is_small: bool, e: Array, e_dot: Array, x: Array, m: int, out: Array, work: Array
) -> None:
    """Write `Ė x` (m,) of a twist `x` (6,), with what `rate_of_error` found."""
    if is_small:
        small_rate_of_rate(e, e_dot, x, out, work[2 * SIX :])
        return
    for i in range(m):
        out[i] = 0.0
        for j in range(SIX):
            out[i] += work[SIX + i, j] * x[j]


@kernel
def times_jacobian(E: Array, J: Array, m: int, out: Array) -> None:
    """Write `E J` (m, nv); half of `E` is zero, which is left out."""
    for i in range(m):
        for c in range(J.shape[1]):
            out[i, c] = E[i, 0] * J[0, c]
        for j in range(1, SIX):
            share = E[i, j]
            if share != 0.0:
                for c in range(J.shape[1]):
                    out[i, c] += share * J[j, c]
