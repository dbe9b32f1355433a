"""One row for each run of the suite, and the table of all rows."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from fotsmc_pin.analysis import summarize
from fotsmc_pin.errors import DivergenceError
from fotsmc_pin.files import markdown_table

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.stress.scenario import Scenario
    from fotsmc_pin.simulation import Recording

INFINITE = float("inf")
FAILED_ERROR = 0.5
"""Tail RMS error above which a run counts as diverged though its speeds stayed bounded [rad]."""


@dataclass(frozen=True, kw_only=True)
class StressRow:
    """Metrics of a run of the suite; the tail is the last half of the run.

    Attributes:
        arm: name of the arm.
        controller: name of the controller, with what was changed in it.
        tail_rms_error: RMS of the norm of the error in the tail [rad].
        max_tail_error: largest norm of the error in the tail [rad].
        settling_time: time after which the error stays below 10 mrad [s].
        torque_variation: in the tail [N·m/s].
        saturation_fraction: share of ticks at which some joint is at its effort limit.
        diverged: a joint's speed exceeded every bound, or the tail RMS error is above 0.5 rad.
    """

    arm: str
    controller: str
    tail_rms_error: float = INFINITE
    max_tail_error: float = INFINITE
    settling_time: float = INFINITE
    torque_variation: float = INFINITE
    saturation_fraction: float = 1.0
    diverged: bool = True

    def as_dict(self) -> dict[str, Any]:
        """Return the row as plain data."""
        return asdict(self)


def run_row(scenario: Scenario, controller: Controller, label: str, duration: float) -> StressRow:
    """Return the row of a controller in a scenario; a divergence is a result too."""
    try:
        rec = scenario.run(controller, duration)
    except DivergenceError:
        return StressRow(arm=scenario.arm.name, controller=label)
    return judge(rec, scenario.arm.name, label)


def judge(rec: Recording, arm: str, label: str) -> StressRow:
    """Return the row of a run of the controller `label` on `arm`."""
    summary = summarize(rec)
    return StressRow(
        arm=arm,
        controller=label,
        tail_rms_error=summary.tail_rms_error,
        max_tail_error=summary.max_tail_error,
        settling_time=summary.settling_time,
        torque_variation=summary.tail_torque_variation,
        saturation_fraction=summary.saturation_fraction,
        diverged=summary.tail_rms_error > FAILED_ERROR,
    )


COLUMNS = (
    "arm",
    "controller",
    "tail RMS [mrad]",
    "tail max [mrad]",
    "10 mrad by [s]",
    "torque variation [N·m/s]",
    "saturated [%]",
    "diverged",
)


def cells(row: StressRow) -> tuple[str, ...]:
    """Return the row as text, one cell per column of `COLUMNS`."""
    return (
        row.arm,
        row.controller,
        _number(1e3 * row.tail_rms_error),
        _number(1e3 * row.max_tail_error),
        "never" if row.settling_time == INFINITE else f"{row.settling_time:.2f}",
        _number(row.torque_variation),
        f"{100.0 * row.saturation_fraction:.1f}",
        "yes" if row.diverged else "no",
    )


def markdown(rows: Iterable[StressRow]) -> str:
    """Return the rows as a Markdown table."""
    return markdown_table(COLUMNS, map(cells, rows), align="ll" + "r" * (len(COLUMNS) - 2))


def _number(value: float) -> str:
    return "∞" if value == INFINITE else f"{value:.3g}" if value < 1000.0 else f"{value:.0f}"
