"""The Grünwald-Letnikov weights as a sum of powers, with a certificate of their error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional.exponential_sum import (
    merge_slow_rates,
    refuse_too_many,
    trapezoid,
    trapezoid_step,
)
from fotsmc_pin.fractional.gauss import merge

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class WeightSum:
    """`Σ_k weights_k λ_k^{j+1}`, `λ_k = 1/(1 + rates_k)`: the weight of a sample `j` periods old.

    It approximates `Π_{i≤j} (1 - β/i)`, the weights of the integral of order `1-β` on a clock of
    period 1. With `differences`, each is reduced by the one before it: the weights of the
    derivative of order `β`. The weight of the newest sample, 1, is exact and not part of the sum.

    Attributes:
        exponent: `β`, between 0 and 1.
        differences: whether the certificate is that of the derivative's weights.
        samples: how many weights are certified.
        tolerance: the relative error that was asked for.
        rates: `s_k ≥ 0`, (modes,), per period.
        weights: (modes,), positive.
        certificate: largest relative error of weights 1 to `samples`, measured.
    """

    exponent: float
    differences: bool
    samples: int
    tolerance: float
    rates: Array
    weights: Array
    certificate: float

    @property
    def modes(self) -> int:
        """Number of powers."""
        return self.rates.size

    def __repr__(self) -> str:
        """Return the certificate in words."""
        return (
            f"WeightSum(exponent={self.exponent:g}, modes={self.modes}, "
            f"relative error at most {self.certificate:.2g} over {self.samples} samples)"
        )


@lru_cache(maxsize=128)
def weight_sum(exponent: float, differences: bool, samples: int, tolerance: float) -> WeightSum:
    """Return a sum for the Grünwald-Letnikov weights that keeps the tolerance.

    `Π_{i≤j} (1 - β/i) = sin(πβ)/π ∫ s^{β-1} (1+s)^{-(j+1)} ds` is taken by the trapezoid rule in
    `log s`; Gauss quadrature merges the slow end (in `s`) and the fast end (in `λ`). The factor
    `1/(1 + s dt)` is a step of the implicit Euler method, so that the same modes serve a clock that
    is not uniform: generalized convolution quadrature [Lopez-Fernandez and Sauter 2013].

    Raises:
        ArgumentError: with a horizon or a tolerance that would work.
    """
    rates, weights, certificate = _search(exponent, differences, samples, tolerance)
    if certificate > tolerance:
        within = 0.0
        while certificate > within:  # What is named must work, and is tried.
            within = float(f"{5 * max(within, certificate):.1g}")
            *_, certificate = _search(exponent, differences, samples, within)
        raise ArgumentError("tolerance", tolerance, f"give at least {within:.1g}")
    for array in (rates, weights):
        array.setflags(write=False)
    return WeightSum(
        exponent=exponent,
        differences=differences,
        samples=samples,
        tolerance=tolerance,
        rates=rates,
        weights=weights,
        certificate=certificate,
    )


def _search(
    exponent: float, differences: bool, samples: int, tolerance: float
) -> tuple[Array, Array, float]:
    """Return rates, weights and certificate of the first sum within `tolerance`, or of the best."""
    # A difference of weights is the integral with s^β in place of s^{β-1}, and magnifies the
    # errors of merged slow rates by up to 16/β.
    share = 0.1 * exponent / 16 if differences else 0.1
    best: tuple[Array, Array, float] = np.empty(0), np.empty(0), math.inf
    aim = tolerance
    while best[2] > tolerance and aim >= 0.03 * tolerance:
        step = trapezoid_step(exponent + differences, aim)
        rates, weights = trapezoid(exponent, 1e18, 1e-18 / samples, step)
        rates, weights = merge_slow_rates(rates, weights, samples, exponent, share * aim)
        rates, weights = _merge_fast_rates(rates, weights, exponent, aim, differences)
        refuse_too_many(rates.size, step, samples)
        certificate = _largest_relative_error(rates, weights, exponent, samples, differences)
        if certificate < best[2]:
            best = rates, weights, certificate
        aim /= 2
    return best


def integral_weights(exponent: float, ages: Array) -> Array:
    """Return `Π_{i≤j} (1 - β/i) = Γ(j+1-β) / (Γ(1-β) j!)` for whole ages `j ≥ 0`, to rounding."""
    direct = 2000
    table = np.cumprod(np.append(1.0, 1.0 - exponent / np.arange(1, direct)))
    shifted = np.maximum(ages, direct - 1) + 0.5 * (1 - exponent)
    tail = shifted**-exponent / math.gamma(1 - exponent)
    tail *= 1.0 + exponent * (exponent**2 - 1.0) / (24.0 * shifted**2)
    return np.where(ages < direct, table[np.minimum(ages, direct - 1).astype(int)], tail)


def _merge_fast_rates(
    rates: Array, weights: Array, exponent: float, tolerance: float, differences: bool
) -> tuple[Array, Array]:
    """Merge the powers that decay within a few samples."""
    ages = np.arange(1.0, 40.0)
    allowed = 0.1 * tolerance * integral_weights(exponent, ages)
    if differences:
        allowed *= exponent / ages
    allowed = np.maximum(allowed, 1e-15)
    factors = 1.0 / (1.0 + rates)
    factors, masses = merge(
        factors,
        weights * factors**2,  # the weight of the sample one period old
        (0.02, 0.05, 0.1, 0.2, 0.3, 0.4),
        lambda nodes: nodes ** (ages[:, None] - 1),
        allowed,
    )
    factors = np.maximum(factors, 1e-30)
    return 1.0 / factors - 1.0, masses / factors**2


def _largest_relative_error(
    rates: Array, weights: Array, exponent: float, samples: int, differences: bool
) -> float:
    """Measure on the first hundred weights, then on 200 per decade."""
    number = max(200, math.ceil(200 * math.log10(samples)))
    ages = np.unique(np.append(np.arange(1.0, 100.0), np.rint(np.geomspace(1, samples, number))))
    exact = integral_weights(exponent, ages)
    powers = np.exp(-np.outer(ages + 1, np.log1p(rates)))
    if not differences:
        return float(np.max(np.abs(powers @ weights / exact - 1)))
    exact *= -exponent / (ages - exponent)
    values = -powers @ (weights * rates)
    values[0] = powers[0] @ weights - 1.0
    return float(np.max(np.abs(values / exact - 1)))
