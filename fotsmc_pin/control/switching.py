"""Switching functions: the sign of sliding mode, and its continuous stand-ins."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from collections.abc import Mapping

SWITCHING = ("sign", "saturation", "tanh", "power")
"""Names of the switching functions, in the order of their codes inside kernels.

- `sign`: `sign(s)`, the pure sliding mode;
- `saturation`: `s/φ` inside the boundary layer `|s| ≤ φ`, the sign outside;
- `tanh`: `tanh(s/φ)`;
- `power`: `sig(s/φ)^½` inside the boundary layer, the sign outside.
"""

SIGN, SATURATION, TANH, POWER = range(4)

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
def switch(s: float, kind: int, phi: float) -> float:
    """The switching function of code `kind` with boundary layer `phi`, a value in [-1, 1]."""
    if kind == TANH:
        return math.tanh(s / phi)
    if kind != SIGN and abs(s) < phi:
        return s / phi if kind == SATURATION else math.copysign(math.sqrt(abs(s / phi)), s)
    if s == 0.0:
        return 0.0
    return math.copysign(1.0, s)
