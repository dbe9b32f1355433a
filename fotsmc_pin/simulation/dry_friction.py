"""Joint friction taken implicitly, so that a joint can stand still and a light one stays stable."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


SWEEPS = 50
"""Most sweeps of Gauss-Seidel in a step; one that starts from the last impulses needs few."""
CLOSE_ENOUGH = 1e-9
"""Change of speed below which sweeps end, relative to the largest speed + 1 [rad/s, m/s]."""


@kernel
def apply_friction(
    h: float, inverse_mass: Array, friction: Array, damping: Array, impulse: Array, v: Array
) -> None:
    """Move `v` from the speed without friction to the speed with it, after a step of `h` seconds.

    Solves, with `v` the speed at the end of the step,

        v = v_free + M⁻¹ p,    p_j = -h (D_j v_j + F_j sign v_j),   |p_j| ≤ h F_j where v_j = 0,

    by Gauss-Seidel, each joint exactly, one after the other. It is stable for any step and joint.

    Args:
        h: length of the step [s].
        inverse_mass: `M⁻¹` (nv, nv).
        friction: Coulomb friction `F` (nv,) [N·m, N].
        damping: viscous friction `D` (nv,) [N·m·s/rad, N·s/m].
        impulse: `p` of the last step (nv,), to start from; overwritten with this step's.
        v: speed without friction (nv,); overwritten.
    """
    n = v.size
    for i in range(n):
        for j in range(n):
            v[i] += inverse_mass[i, j] * impulse[j]
    for _ in range(SWEEPS):
        moved, fastest = 0.0, 1.0
        for j in range(n):
            own = inverse_mass[j, j]
            free = v[j] - own * impulse[j]
            slip = max(abs(free) - h * friction[j] * own, 0.0) / (1.0 + h * damping[j] * own)
            new = (math.copysign(slip, free) - free) / own
            change = new - impulse[j]
            impulse[j] = new
            for i in range(n):
                v[i] += inverse_mass[i, j] * change
            moved = max(moved, abs(own * change))
            fastest = max(fastest, abs(v[j]))
        if moved < CLOSE_ENOUGH * fastest:
            break
