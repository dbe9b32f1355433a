"""Exact integrals over one sampling interval, for an input that is a polynomial there.

Inside an interval of length `h` the input of the kernel is `f_0 + f_1 ξ + f_2 ξ²`, where `ξ`
runs from 0 to 1 backwards from the new sample in units of `h`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.fractional.layout import (
    DIFFERENTIATES,
    EXPONENT,
    GRUNWALD_LETNIKOV,
    HEADER,
    MODES,
    NORMALIZER,
    RATE,
    SCHEME,
    TEMPERING,
    WEIGHT,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]
    Three: TypeAlias = tuple[float, float, float]


@kernel
def kernel_input(
    header: Array, period: float, value: float, difference: float, curvature: float
) -> Three:
    """Return `f_0, f_1, f_2`, linear in the three numbers that describe `x` on the interval.

    The input is `x(ξ) = value - difference ξ + curvature (ξ² - ξ)`. An integral hands `x` to its
    kernel and a derivative `x' + σ x`. Grünwald-Letnikov knows samples only: a backward difference.
    """
    differentiates, tempering = header[DIFFERENTIATES] == 1.0, header[TEMPERING]
    if header[SCHEME] == GRUNWALD_LETNIKOV:
        if differentiates:
            fade = math.exp(-tempering * period)
            return ((1.0 - fade) * value + fade * difference) / period, 0.0, 0.0
        return value, 0.0, 0.0
    slope = -(difference + curvature)
    if differentiates:
        return (
            tempering * value - slope / period,
            tempering * slope - 2.0 * curvature / period,
            tempering * curvature,
        )
    return value, slope, curvature


@kernel
def exponential_moments(z: float, decay: float) -> Three:
    """Return `∫_0^1 e^{-zξ} ξ^m dξ` for m = 0, 1, 2, where `decay = e^{-z}`."""
    if z < 1.0:
        term, second, j = 1.0, 1.0 / 3.0, 1
        while abs(term) > 1e-17:
            term *= -z / j
            second += term / (j + 3)
            j += 1
        first = (z * second + decay) / 2.0
        return z * first + decay, first, second
    zeroth = (1.0 - decay) / z
    first = (zeroth - decay) / z
    return zeroth, first, (2.0 * first - decay) / z


@kernel
def local_moments(header: Array, period: float) -> Three:
    """Return `h ∫_0^1 k(hξ) ξ^m dξ` for m = 0, 1, 2 with `k(t) = e^{-σt} t^{-β}/Γ(1-β)`."""
    exponent = header[EXPONENT]
    if exponent == 1.0:
        return 1.0, 0.0, 0.0
    if header[SCHEME] == GRUNWALD_LETNIKOV:
        return period ** (1.0 - exponent), 0.0, 0.0
    z = header[TEMPERING] * period
    scale = header[NORMALIZER] * period ** (1.0 - exponent)
    power = 3.0 - exponent
    fade = math.exp(-z)
    if z < 50.0:
        term = second = 1.0 / power
        j = 1
        while term > 1e-17 * second:
            term *= z / (power + j)
            second += term
            j += 1
        second *= fade
    else:  # The upper end of the integral is beyond rounding.
        second = math.gamma(power) / z**power
    first = (fade + z * second) / (power - 1.0)
    return scale * (fade + z * first) / (power - 2.0), scale * first, scale * second


@kernel
def mode_response(coefficients: Array, k: int, period: float) -> tuple[float, float, float, float]:
    """Return the decay of mode `k` over a period, and what `f_0, f_1, f_2` add to it."""
    header = coefficients[HEADER]
    rate, weight = coefficients[RATE, k], coefficients[WEIGHT, k]
    if header[SCHEME] == GRUNWALD_LETNIKOV:  # implicit Euler
        factor = 1.0 / (1.0 + rate * period)
        return math.exp(-header[TEMPERING] * period) * factor, weight * period * factor, 0.0, 0.0
    z = (rate + header[TEMPERING]) * period
    decay = math.exp(-z)
    zeroth, first, second = exponential_moments(z, decay)
    scale = weight * period
    return decay, scale * zeroth, scale * first, scale * second


@kernel
def response_table(coefficients: Array, period: float) -> Array:
    """Return decays and gains of all modes over a period, (4, modes)."""
    table = np.empty((4, int(coefficients[HEADER, MODES])))
    for k in range(table.shape[1]):
        table[0, k], table[1, k], table[2, k], table[3, k] = mode_response(coefficients, k, period)
    return table


@kernel
def decay_table(coefficients: Array, period: float) -> Array:
    """Return the decays of all modes over a period, (1, modes)."""
    header = coefficients[HEADER]
    table = np.empty((1, int(header[MODES])))
    fade = math.exp(-header[TEMPERING] * period)
    for k in range(table.shape[1]):
        rate = coefficients[RATE, k]
        if header[SCHEME] == GRUNWALD_LETNIKOV:
            table[0, k] = fade / (1.0 + rate * period)
        else:
            table[0, k] = math.exp(-(rate + header[TEMPERING]) * period)
    return table
