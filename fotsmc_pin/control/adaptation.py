"""Adaptation of the uncertainty bounds `B̂0 + B̂1 ‖v‖`: the printed law and the practical ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.norm import norm

if TYPE_CHECKING:
    from fotsmc_pin.control.gains import Array

ADAPTATION = ("printed", "dead_zone", "leakage", "projection")
"""Names of the adaptation laws, in the order of their codes inside kernels.

- `printed`: `dB̂/dt = rate ‖S‖ (1, ‖v‖)`, [23], [24]; never falls, since `‖S‖ ≥ 0`;
- `dead_zone`: the same, at rest while `‖S‖` is below a threshold;
- `leakage`: `dB̂/dt = rate ‖S‖ (1, ‖v‖) - leak (B̂ - B̂(0))` (σ-modification), so that it forgets,
  held at a largest value;
- `projection`: the printed law, held at a largest value.
"""

PRINTED, DEAD_ZONE, LEAKAGE, PROJECTION = range(4)


@kernel
def adapt(
    dt: float, B: Array, B_start: Array, S: Array, v: Array, kind: int, parameters: Array
) -> None:
    """Advance `B = (B̂0, B̂1)` by one tick; `parameters`: rates of both, threshold, leak, largest."""
    rate_0, rate_1, threshold, leak, largest = (
        parameters[0], parameters[1], parameters[2], parameters[3], parameters[4],
    )  # fmt: skip
    S_norm, speed = norm(S), norm(v)
    if kind == DEAD_ZONE and S_norm < threshold:
        return
    B[0] += dt * rate_0 * S_norm  # [23]
    B[1] += dt * rate_1 * S_norm * speed  # [24]
    if kind == LEAKAGE:
        fade = math.exp(-leak * dt)
        for k in range(2):
            B[k] = B_start[k] + (B[k] - B_start[k]) * fade
    if kind in (LEAKAGE, PROJECTION):
        for k in range(2):
            B[k] = min(B[k], largest)
