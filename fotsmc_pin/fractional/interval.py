"""What the newest sampling interval adds to a mode and to the output.

On an interval of length `h` the input is taken as

    x(ξ) = value - difference ξ + curvature (ξ² - ξ),

where `ξ` runs from 0 to 1 backwards from the new sample in units of `h`. The memory kernel acts on
`x` in an integral and on `x' + σ x` in a derivative, and all integrals over the interval are exact.
What they add is linear in value, difference and curvature: three gains.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.fractional.layout import GRUNWALD_LETNIKOV

if TYPE_CHECKING:
    from typing import TypeAlias

    Three: TypeAlias = tuple[float, float, float]
    Four: TypeAlias = tuple[float, float, float, float]


@kernel
def gains(
    scheme: float, slope: float, tempering: float, period: float, m0: float, m1: float, m2: float
) -> Three:
    """Return the gains of value, difference and curvature for a memory kernel with these moments.

    Moment `m` is the integral of the memory kernel times `ξ^m` over the interval; `slope` is 1
    where it acts on `x' + σ x`, 0 where on `x`. Grünwald-Letnikov knows samples only: its
    derivative acts on the backward difference of `e^{σt} x`.
    """
    if slope == 0.0:
        if scheme == GRUNWALD_LETNIKOV:
            return m0, 0.0, 0.0
        return m0, -m1, m2 - m1
    if scheme == GRUNWALD_LETNIKOV:
        fade = math.exp(-tempering * period)
        return (1.0 - fade) / period * m0, fade / period * m0, 0.0
    return (
        tempering * m0,
        m0 / period - tempering * m1,
        (m0 - 2.0 * m1) / period + tempering * (m2 - m1),
    )


@kernel
def output_gains(
    scheme: float,
    slope: float,
    tempering: float,
    period: float,
    exponent: float,
    normalizer: float,
) -> Three:
    """Return what value, difference and curvature add to the output.

    The memory kernel is `k(t) = e^{-σt} t^{-β}/Γ(1-β)`; its moments are `h ∫_0^1 k(hξ) ξ^m dξ`.
    """
    if exponent == 1.0:  # no memory
        return gains(scheme, slope, tempering, period, 1.0, 0.0, 0.0)
    scale = period ** (1.0 - exponent)
    if scheme == GRUNWALD_LETNIKOV:
        return gains(scheme, slope, tempering, period, scale, 0.0, 0.0)
    scale *= normalizer
    m0, m1, m2 = power_moments(exponent, tempering * period)
    return gains(scheme, slope, tempering, period, scale * m0, scale * m1, scale * m2)


@kernel
def mode_decay(scheme: float, tempering: float, period: float, rate: float) -> float:
    """Return the factor by which a mode decays over a period."""
    if scheme == GRUNWALD_LETNIKOV:  # implicit Euler
        return math.exp(-tempering * period) / (1.0 + rate * period)
    return math.exp(-(rate + tempering) * period)


@kernel
def mode_response(
    scheme: float, slope: float, tempering: float, period: float, rate: float, weight: float
) -> Four:
    """Return the decay of a mode, and what value, difference and curvature add to it."""
    decay = mode_decay(scheme, tempering, period, rate)
    scale = weight * period
    if scheme == GRUNWALD_LETNIKOV:
        m0 = scale / (1.0 + rate * period)
        g0, g1, g2 = gains(scheme, slope, tempering, period, m0, 0.0, 0.0)
    else:
        m0, m1, m2 = exponential_moments((rate + tempering) * period, decay)
        g0, g1, g2 = gains(scheme, slope, tempering, period, scale * m0, scale * m1, scale * m2)
    return decay, g0, g1, g2


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
def power_moments(exponent: float, z: float) -> Three:
    """Return `∫_0^1 e^{-zξ} ξ^{m-β} dξ` for m = 0, 1, 2."""
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
    else:  # What lies beyond the upper end is below rounding.
        second = math.gamma(power) / z**power
    first = (fade + z * second) / (power - 1.0)
    return (fade + z * first) / (power - 2.0), first, second
