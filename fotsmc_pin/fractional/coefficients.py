"""The table of coefficients of an operator, computed once from its description."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.fractional.exponential_sum import ExponentialSum, power_law_sum
from fotsmc_pin.fractional.grunwald_letnikov import WeightSum, weight_sum
from fotsmc_pin.fractional.interval import mode_response, output_gains
from fotsmc_pin.fractional.layout import (
    DECAY,
    DIFFERENTIATES,
    EXPONENT,
    GAIN,
    GRUNWALD_LETNIKOV,
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
    from fotsmc_pin.types import Array


SCHEMES = {
    "linear": LINEAR,
    "quadratic": QUADRATIC,
    "grunwald-letnikov": GRUNWALD_LETNIKOV,
}

SHORTEST_PERIOD = 0.25
"""The sums hold from this part of the nominal period on, so that a clock may jitter."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Everything that determines the coefficients of an operator."""

    exponent: float
    differentiates: bool
    from_rest: bool
    scheme: str
    dt: float
    horizon: float
    tolerance: float
    tempering: float


def sum_of_exponentials(plan: Plan) -> ExponentialSum | WeightSum | None:
    """Return the sum that carries the past; None for `β = 0` and `β = 1`, which need none."""
    if plan.exponent in (0.0, 1.0):
        return None
    if plan.scheme == "grunwald-letnikov":
        samples = max(2, round(plan.horizon / plan.dt))
        return weight_sum(plan.exponent, plan.differentiates, samples, plan.tolerance)
    return power_law_sum(plan.exponent, SHORTEST_PERIOD * plan.dt, plan.horizon, plan.tolerance)


def _modes(plan: Plan) -> tuple[Array, Array]:
    """Rates [1/s] and weights of the modes."""
    if plan.exponent == 1.0:  # no memory
        return np.empty(0), np.empty(0)
    found = sum_of_exponentials(plan)
    if found is None:  # The memory kernel is the constant 1.
        return np.zeros(1), np.ones(1)
    if isinstance(found, WeightSum):
        return found.rates / plan.dt, found.weights * plan.dt**-plan.exponent
    return found.rates, found.weights


@lru_cache(maxsize=128)
def coefficient_table(plan: Plan) -> Array:
    """Return the read-only coefficients, laid out as in `layout`."""
    rates, weights = _modes(plan)
    modes, dt = rates.size, plan.dt
    table = np.zeros((ROWS, max(HEADER_COLUMNS, modes)))
    header = table[HEADER]
    header[PERIOD] = dt
    header[SCHEME] = SCHEMES[plan.scheme]
    header[DIFFERENTIATES] = float(plan.differentiates)
    header[EXPONENT] = plan.exponent
    header[NORMALIZER] = 1 / math.gamma(1 - plan.exponent) if plan.exponent < 1 else 0.0
    header[TEMPERING] = plan.tempering
    kind = header[SCHEME], header[DIFFERENTIATES], plan.tempering, dt
    header[OUTPUT_GAINS : OUTPUT_GAINS + 3] = output_gains(*kind, plan.exponent, header[NORMALIZER])
    header[MODES] = modes
    table[RATE, :modes] = rates
    table[WEIGHT, :modes] = weights
    for k in range(modes):
        table[DECAY:, k] = mode_response(*kind, rates[k], weights[k])
    _set_start(table, plan)
    table.setflags(write=False)
    return table


def _set_start(table: Array, plan: Plan) -> None:
    """Write what the first sample does: a step up from rest, or a start that makes no difference.

    To Grünwald-Letnikov the step is a sample like any other. The other schemes take it as an
    impulse of `x'`, which the modes remember; its own instant, where the derivative is infinite,
    is given as 0.
    """
    header = table[HEADER]
    if plan.exponent == 1.0 and not plan.differentiates:
        header[START_GAIN] = 1.0
    elif plan.scheme == "grunwald-letnikov" and not plan.differentiates:
        header[START_GAIN] = header[OUTPUT_GAINS]
        table[START] = table[GAIN]
    elif plan.scheme == "grunwald-letnikov" and plan.from_rest:
        header[START_GAIN] = header[OUTPUT_GAINS] + header[OUTPUT_GAINS + 1]
        table[START] = table[GAIN] + table[GAIN + 1]
    elif plan.from_rest:
        table[START] = table[WEIGHT]
