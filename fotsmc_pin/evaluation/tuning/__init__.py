"""Searching gains: what may be drawn, and the search."""

from fotsmc_pin.evaluation.tuning.front import FrontPoint, tune
from fotsmc_pin.evaluation.tuning.minimize import minimize
from fotsmc_pin.evaluation.tuning.search import Tuned, search_gains
from fotsmc_pin.evaluation.tuning.space import Span, search_space

__all__ = [
    "FrontPoint",
    "Span",
    "Tuned",
    "minimize",
    "search_gains",
    "search_space",
    "tune",
]
