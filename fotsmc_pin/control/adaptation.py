"""Adaptation of the uncertainty bounds `B̂0 + B̂1 ‖v‖`: the printed law and the practical ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.gains import codes

if TYPE_CHECKING:
    from fotsmc_pin.control.adaptive_fonftsm import AdaptiveFONFTSMGains
    from fotsmc_pin.types import Array

ADAPTATION = ("printed", "dead_zone", "leakage", "projection")
"""Names of the adaptation laws, in the order of their codes inside kernels.

- `printed`: `dB̂/dt = rate ‖S‖ (1, ‖v‖)`, [23], [24]; never falls, since `‖S‖ ≥ 0`;
- `dead_zone`: the same, at rest while `‖S‖` is below a threshold;
- `leakage`: `dB̂/dt = rate ‖S‖ (1, ‖v‖) - leak (B̂ - B̂(0))` (σ-modification), so that it forgets,
  held at a largest value;
- `projection`: the printed law, held at a largest value.
"""

PRINTED, DEAD_ZONE, LEAKAGE, PROJECTION = codes(ADAPTATION)

RATES = ("inverse", "direct")

INVERSE, DIRECT = codes(RATES)


class Estimates(NamedTuple):
    """The estimates, one of each for the whole arm: every joint's entry is the same.

    Attributes:
        B0_hat: estimate `B̂0` [N·m].
        B1_hat: estimate `B̂1` [N·m·s/rad].
    """

    B0_hat: Array
    B1_hat: Array


@kernel(is_part=True)
def adapt(dt: float, g: AdaptiveFONFTSMGains, m: Estimates, S_norm: float, speed: float) -> None:
    """Advance `B̂0` and `B̂1` by one tick, with `‖S‖` and `‖v‖`."""
    if g.adaptation == DEAD_ZONE and S_norm < g.dead_zone:
        return
    inverse = g.adaptation_rate == INVERSE
    rate_0 = 1.0 / g.upsilon_0 if inverse else g.upsilon_0
    rate_1 = 1.0 / g.upsilon_1 if inverse else g.upsilon_1
    fade = math.exp(-g.leakage * dt)
    for i in range(m.B0_hat.size):
        m.B0_hat[i] += dt * rate_0 * S_norm  # [23]
        m.B1_hat[i] += dt * rate_1 * S_norm * speed  # [24]
        if g.adaptation == LEAKAGE:
            m.B0_hat[i] = g.B0_start + (m.B0_hat[i] - g.B0_start) * fade
            m.B1_hat[i] = g.B1_start + (m.B1_hat[i] - g.B1_start) * fade
        if g.adaptation in (LEAKAGE, PROJECTION):
            m.B0_hat[i] = min(m.B0_hat[i], g.largest_bound)
            m.B1_hat[i] = min(m.B1_hat[i], g.largest_bound)
