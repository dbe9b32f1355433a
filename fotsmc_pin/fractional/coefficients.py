"""The table of coefficients of an operator, computed once from its description."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fotsmc_pin.fractional.exponential_sum import ExponentialSum, power_law_sum
from fotsmc_pin.fractional.interval import mode_response, output_gains
from fotsmc_pin.fractional.layout import (
    DECAY,
    DIFFERENTIATES,
    EXPONENT,
    HEADER,
    HEADER_COLUMNS,
    LINEAR,
    MODES,
    NORMALIZER,
    OUTPUT_GAINS,
    PERIOD,
    QUADRATIC,
    RATE,
    ROWS,
    SCHEME,
    START,
    START_GAIN,
    TEMPERING,
    WEIGHT,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

SCHEMES = {"linear": LINEAR, "quadratic": QUADRATIC}

SHORTEST_PERIOD = 0.25
"""The sums hold from this part of the nominal period on, so that a clock may jitter."""


@lru_cache(maxsize=128)
def history_kernel(
    exponent: float, dt: float, horizon: float, tolerance: float
) -> ExponentialSum | None:
    """Return the sum of exponentials of `t^{-β}/Γ(1-β)`; None for `β = 0` and 1, which need none."""
    if exponent in (0.0, 1.0):
        return None
    return power_law_sum(exponent, SHORTEST_PERIOD * dt, horizon, tolerance)


@lru_cache(maxsize=128)
def coefficient_table(
    *,
    exponent: float,
    differentiates: bool,
    scheme: str,
    dt: float,
    horizon: float,
    tolerance: float,
    tempering: float,
) -> Array:
    """Return the read-only coefficients, laid out as in `layout`."""
    rates, weights = np.empty(0), np.empty(0)
    if exponent == 0.0:  # The kernel is the constant 1.
        rates, weights = np.zeros(1), np.ones(1)
    kernel = history_kernel(exponent, dt, horizon, tolerance)
    if kernel is not None:
        rates, weights = kernel.rates, kernel.weights
    table = np.zeros((ROWS, max(HEADER_COLUMNS, rates.size)))
    header = table[HEADER]
    header[MODES] = rates.size
    header[PERIOD] = dt
    header[SCHEME] = SCHEMES[scheme]
    header[DIFFERENTIATES] = float(differentiates)
    header[EXPONENT] = exponent
    header[NORMALIZER] = 1 / math.gamma(1 - exponent) if exponent < 1 else 0.0
    header[TEMPERING] = tempering
    header[START_GAIN] = 1.0 if exponent == 1.0 and not differentiates else 0.0
    kind = header[SCHEME], header[DIFFERENTIATES], tempering, dt
    header[OUTPUT_GAINS : OUTPUT_GAINS + 3] = output_gains(*kind, exponent, header[NORMALIZER])
    table[RATE, : rates.size] = rates
    table[WEIGHT, : rates.size] = weights
    table[START] = 0.0
    for k in range(rates.size):
        table[DECAY:, k] = mode_response(*kind, rates[k], weights[k])
    table.setflags(write=False)
    return table
