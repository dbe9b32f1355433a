"""Streaming fractional calculus: derivatives and integrals of any order from 0 to 1."""

from fotsmc_pin.fractional.advance import advance, commit, predict
from fotsmc_pin.fractional.exponential_sum import ExponentialSum, power_law_sum
from fotsmc_pin.fractional.grunwald_letnikov import WeightSum
from fotsmc_pin.fractional.operators import (
    FractionalDerivative,
    FractionalIntegral,
    FractionalOperator,
)
from fotsmc_pin.fractional.stream import Stream

__all__ = [
    "ExponentialSum",
    "FractionalDerivative",
    "FractionalIntegral",
    "FractionalOperator",
    "Stream",
    "WeightSum",
    "advance",
    "commit",
    "power_law_sum",
    "predict",
]
