"""Streaming fractional calculus: derivatives and integrals of non-integer order, sample by sample."""

from fotsmc_pin.fractional.advance import advance, commit, predict
from fotsmc_pin.fractional.exponential_sum import ExponentialSum, power_law_sum
from fotsmc_pin.fractional.operators import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.stream import Stream

__all__ = [
    "ExponentialSum",
    "FractionalDerivative",
    "FractionalIntegral",
    "Stream",
    "advance",
    "commit",
    "power_law_sum",
    "predict",
]
