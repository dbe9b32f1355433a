"""Analysis: metrics of a run, and what theory predicts for a law."""

from fotsmc_pin.analysis.bounds import reaching_time_bound, settling_time_bound
from fotsmc_pin.analysis.elastic_bandwidth import (
    OBSERVED_SHARE,
    BandwidthWarning,
    largest_bandwidth,
    warn_of_soft_joints,
    with_bandwidth,
)
from fotsmc_pin.analysis.inertia_ratios import InertiaRatios, inertia_ratios
from fotsmc_pin.analysis.margins import Margins, margins
from fotsmc_pin.analysis.metrics import (
    Summary,
    settling_time,
    summarize,
    summarize_by_unit,
    units,
)
from fotsmc_pin.analysis.rest import reference_stop, swings, time_to_rest
from fotsmc_pin.analysis.surface import sector_margin, surface_decay, surface_margin
from fotsmc_pin.analysis.tool import tool_errors
from fotsmc_pin.analysis.torque_rate import (
    TorqueRateWarning,
    asked_torque_rate,
    warn_of_torque_rate,
)
from fotsmc_pin.control.conditions import obeys_power_condition
from fotsmc_pin.simulation.pose_errors import pose_errors

__all__ = [
    "OBSERVED_SHARE",
    "BandwidthWarning",
    "InertiaRatios",
    "Margins",
    "Summary",
    "TorqueRateWarning",
    "asked_torque_rate",
    "inertia_ratios",
    "largest_bandwidth",
    "margins",
    "obeys_power_condition",
    "pose_errors",
    "reaching_time_bound",
    "reference_stop",
    "sector_margin",
    "settling_time",
    "settling_time_bound",
    "summarize",
    "summarize_by_unit",
    "surface_decay",
    "surface_margin",
    "swings",
    "time_to_rest",
    "tool_errors",
    "units",
    "warn_of_soft_joints",
    "warn_of_torque_rate",
    "with_bandwidth",
]
