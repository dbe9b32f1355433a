"""The Euclidean norm, for kernels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.control.gains import Array


@kernel
def norm(x: Array) -> float:
    """`‖x‖`, without the call into BLAS that costs more than the sum of a few squares."""
    total = 0.0
    for value in x:
        total += value * value
    return math.sqrt(total)
