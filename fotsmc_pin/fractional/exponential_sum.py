"""The power law as a sum of decaying exponentials, with a certificate of its error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional.gauss import merge

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


MOST_MODES = 96
"""More modes than this are refused: the horizon or the tolerance asks for too much."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ExponentialSum:
    """`Σ_k weights_k e^{-rates_k t}`, which approximates `t^{-β}/Γ(1-β)` on `[shortest, longest]`.

    Attributes:
        exponent: `β`, between 0 and 1.
        shortest: where the certificate begins [s].
        longest: where the certificate ends [s].
        tolerance: the relative error that was asked for.
        rates: `s_k ≥ 0`, (modes,) [1/s].
        weights: `w_k > 0`, (modes,).
        certificate: largest relative error on `[shortest, longest]`, measured.
    """

    exponent: float
    shortest: float
    longest: float
    tolerance: float
    rates: Array
    weights: Array
    certificate: float

    @property
    def modes(self) -> int:
        """Number of exponentials."""
        return self.rates.size

    def __call__(self, t: Array) -> Array:
        """Return the sum at the times `t` [s]."""
        return np.exp(-np.multiply.outer(t, self.rates)) @ self.weights

    def __repr__(self) -> str:
        """Return the certificate in words."""
        return (
            f"ExponentialSum(exponent={self.exponent:g}, modes={self.modes}, "
            f"relative error at most {self.certificate:.2g} "
            f"on [{self.shortest:g}, {self.longest:g}] s)"
        )


@lru_cache(maxsize=128)
def power_law_sum(
    exponent: float, shortest: float, longest: float, tolerance: float
) -> ExponentialSum:
    """Return the shortest sum found for `t^{-β}/Γ(1-β)` that keeps the tolerance.

    The integral `t^{-β}/Γ(1-β) = sin(πβ)/π ∫ e^{βu - e^u t} du` is taken by the trapezoid rule,
    whose error falls exponentially with the step [McLean 2018]. Rates far below `1/longest`, of
    which there would be hundreds for a small `β`, are merged into a few by Gauss quadrature.

    Args:
        exponent: `β`, between 0 and 1.
        shortest: least time at which the sum must hold [s].
        longest: greatest time at which the sum must hold [s].
        tolerance: relative error, 1e-11 to 1e-2.

    Raises:
        ArgumentError: with a horizon or a tolerance that would work.
    """
    step = trapezoid_step(exponent, tolerance)
    fastest = _fastest_rate(exponent, tolerance, step) / shortest
    rates, weights = trapezoid(exponent, fastest, 1e-18 / longest, step)
    rates, weights = merge_slow_rates(rates, weights, longest, exponent, tolerance)
    refuse_too_many(rates.size, step, longest)
    for array in (rates, weights):
        array.setflags(write=False)
    certificate = _largest_relative_error(rates, weights, exponent, shortest, longest)
    return ExponentialSum(
        exponent=exponent,
        shortest=shortest,
        longest=longest,
        tolerance=tolerance,
        rates=rates,
        weights=weights,
        certificate=certificate,
    )


def refuse_too_many(modes: int, step: float, horizon: float) -> None:
    """Raise an `ArgumentError` with a horizon that would work, if there are too many modes."""
    if modes > MOST_MODES:
        within = horizon * math.exp(-(modes - MOST_MODES + 1) * step)
        raise ArgumentError(
            "horizon",
            horizon,
            f"{modes} modes would be needed and {MOST_MODES} is the most: "
            f"give at most {within:.1g} s, or a larger tolerance",
        )


def trapezoid_step(exponent: float, tolerance: float) -> float:
    """Step in `log s` whose aliasing error `2 |Γ(β + 2πi/h)| / Γ(β)` is half the tolerance."""
    frequency = 10.0
    for _ in range(20):
        peak = 4 * math.sqrt(2 * math.pi) * frequency ** (exponent - 0.5) / math.gamma(exponent)
        frequency = max(1.0, 2 / math.pi * math.log(peak / tolerance))
    return 2 * math.pi / frequency


def _fastest_rate(exponent: float, tolerance: float, step: float) -> float:
    """Last rate at which the integrand is above an eighth of the tolerance, at `t = 1`."""
    top = 10.0
    for _ in range(20):
        tail = 8 * step * top**exponent / (math.gamma(exponent) * tolerance)
        top = max(1.0, math.log(tail))
    return top * math.exp(-step)


def trapezoid(exponent: float, fastest: float, slowest: float, step: float) -> tuple[Array, Array]:
    """Rates and weights of `sin(πβ)/π ∫ e^{βu} δ(e^u) du`; the rates below `slowest` stand at 0."""
    number = math.ceil(math.log(fastest / slowest) / step)
    logarithms = math.log(fastest) - step * np.arange(number)
    scale = math.sin(math.pi * exponent) / math.pi * step
    weights = scale * np.exp(exponent * logarithms)
    rest = scale * math.exp(exponent * (logarithms[-1] - step)) / -math.expm1(-exponent * step)
    return np.append(np.exp(logarithms), 0.0), np.append(weights, rest)


def merge_slow_rates(
    rates: Array, weights: Array, longest: float, exponent: float, tolerance: float
) -> tuple[Array, Array]:
    """Merge the rates that are slow on the scale of `longest`, within a quarter tolerance."""
    times = longest * np.logspace(-3, 0, 60)
    return merge(
        rates,
        weights,
        np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0]) / longest,
        lambda nodes: np.exp(-np.outer(times, nodes)),
        np.maximum(0.25 * tolerance, 1e-14) * times**-exponent / math.gamma(1 - exponent),
    )


def _largest_relative_error(
    rates: Array, weights: Array, exponent: float, shortest: float, longest: float
) -> float:
    """Measure on 200 times per decade: the error oscillates about five times in a decade."""
    decades = math.log10(longest / shortest)
    times = np.geomspace(shortest, longest, max(200, math.ceil(200 * decades)))
    law = times**-exponent / math.gamma(1 - exponent)
    values = np.exp(-np.outer(times, rates)) @ weights
    return float(np.max(np.abs(values / law - 1)))
