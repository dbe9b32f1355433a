"""Judging a run: metrics, and what theory says of a law beforehand."""

from fotsmc_pin.analysis.bounds import reaching_time_bound, settling_time_bound
from fotsmc_pin.analysis.elastic_bandwidth import largest_bandwidth
from fotsmc_pin.analysis.inertia_ratios import InertiaRatios, inertia_ratios
from fotsmc_pin.analysis.margins import Margins, margins
from fotsmc_pin.analysis.metrics import Summary, settling_time, summarize
from fotsmc_pin.analysis.surface import sector_margin, surface_decay, surface_margin
from fotsmc_pin.control.paper_condition import obeys_power_condition

__all__ = [
    "InertiaRatios",
    "Margins",
    "Summary",
    "inertia_ratios",
    "largest_bandwidth",
    "margins",
    "obeys_power_condition",
    "reaching_time_bound",
    "sector_margin",
    "settling_time",
    "settling_time_bound",
    "summarize",
    "surface_decay",
    "surface_margin",
]
