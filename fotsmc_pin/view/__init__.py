"""Seeing a run: the offline Meshcat page, and figures for papers."""

from fotsmc_pin.view.data_files import export_data
from fotsmc_pin.view.export import export_html
from fotsmc_pin.view.figures import (
    comparison_figure,
    overview_figure,
    signal_figure,
    torque_figure,
    tracking_figure,
    velocity_figure,
)
from fotsmc_pin.view.identification_report import write_identification
from fotsmc_pin.view.learning_figure import learning_figure
from fotsmc_pin.view.many_runs import distribution_figure, front_figure
from fotsmc_pin.view.margins_figure import margins_figure
from fotsmc_pin.view.plot import plot
from fotsmc_pin.view.report import write_report
from fotsmc_pin.view.style import new_figure, paper_style, save_figure

__all__ = [
    "comparison_figure",
    "distribution_figure",
    "export_data",
    "export_html",
    "front_figure",
    "learning_figure",
    "margins_figure",
    "new_figure",
    "overview_figure",
    "paper_style",
    "plot",
    "save_figure",
    "signal_figure",
    "torque_figure",
    "tracking_figure",
    "velocity_figure",
    "write_identification",
    "write_report",
]
