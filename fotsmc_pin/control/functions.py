"""Scalar functions of the laws, for kernels: powers with a sign, switching, norms, bounds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.gains import codes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.types import Array

SWITCHING = ("sign", "saturation", "tanh", "power")
"""Names of the switching functions: the sign of sliding mode, and its continuous stand-ins.

- `sign`: `sign(s)`, the pure sliding mode;
- `saturation`: `s/φ` inside the boundary layer `|s| ≤ φ`, the sign outside;
- `tanh`: `tanh(s/φ)`;
- `power`: `sig(s/φ)^½` inside the boundary layer, the sign outside.
"""

SIGN, SATURATION, TANH, POWER = codes(SWITCHING)

SIGN_OR_LAYER: Mapping[str, Mapping[str, Any]] = {
    "sign": {},
    "boundary_layer": {"switching": "saturation"},
}
"""Presets of the laws that switch: the pure sliding mode, and the boundary layer."""


@kernel
def sig(x: float, power: float) -> float:
    """`sig(x)^r = |x|^r sign(x)`."""
    return math.copysign(abs(x) ** power, x) if x != 0.0 else 0.0


@kernel
def switch(s: float, switching: Any, phi: float) -> float:
    """The switching function of code `switching` with boundary layer `phi`, between -1 and 1."""
    if switching == TANH:
        return math.tanh(s / phi)
    if switching != SIGN and abs(s) < phi:
        return s / phi if switching == SATURATION else math.copysign(math.sqrt(abs(s / phi)), s)
    if s == 0.0:
        return 0.0
    return math.copysign(1.0, s)


@kernel
def clip(x: float, limit: float) -> float:
    """`x` within ±`limit`."""
    return min(max(x, -limit), limit)


@kernel
def norm(x: Array) -> float:
    """`‖x‖`, without the call into BLAS that costs more than the sum of a few squares."""
    total = 0.0
    for value in x:
        total += value * value
    return math.sqrt(total)
