"""Analysis: metrics of a run, and what theory predicts for a law."""

from fotsmc_pin.analysis.bounds import reaching_time_bound, settling_time_bound
from fotsmc_pin.analysis.metrics import (
    Summary,
    settling_time,
    summarize,
    summarize_by_unit,
    units,
)
from fotsmc_pin.analysis.surface import sector_margin, surface_decay, surface_margin
from fotsmc_pin.control.conditions import obeys_power_condition

__all__ = [
    "Summary",
    "obeys_power_condition",
    "reaching_time_bound",
    "sector_margin",
    "settling_time",
    "settling_time_bound",
    "summarize",
    "summarize_by_unit",
    "surface_decay",
    "surface_margin",
    "units",
]
