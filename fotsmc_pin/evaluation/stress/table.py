"""The tables of the suite: one line per run, and the matrix of runs by scenario."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from fotsmc_pin.evaluation.stress.judging import INFINITE
from fotsmc_pin.files import markdown_table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from fotsmc_pin.evaluation.stress.judging import StressRow

    Metric: TypeAlias = Callable[[StressRow], float | None]

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
DRAWN = "drawn"
"""Variant of a random scenario."""
NONE = "–"
"""Cell of what a run does not have."""

METRICS: Mapping[str, Metric] = {
    "tail RMS error [mrad]": lambda row: 1e3 * row.tail_rms_error,
    "largest swing of a joint at rest [mrad]": lambda row: _scaled(row.largest_swing),
    "arrival time [s]": lambda row: row.arrival_time,
    "overshoot [mrad]": lambda row: _scaled(row.overshoot),
    "torque variation at rest over that without friction": lambda row: row.friction_ratio,
    "tail RMS error of the motors [mrad]": lambda row: _scaled(row.motor_rms_error),
    "RMS deflection of the springs [mrad]": lambda row: _scaled(row.deflection),
    "RMS deflection under the static torque [mrad]": lambda row: _scaled(row.static_deflection),
    "tail RMS error of the tool, way [mm]": lambda row: _scaled(row.tool_way_error),
    "tail RMS error of the tool, turn [mrad]": lambda row: _scaled(row.tool_turn_error),
    "bandwidth on elastic joints": lambda row: row.bandwidth,
}
"""What a matrix can show, by title."""


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


def listing(rows: Sequence[StressRow]) -> list[list[str]]:
    """Return a line for each run, after a head; the scenario stands there where it may differ."""
    lines = [[*COLUMNS], *([*cells(row)] for row in rows)]
    if any(row.variant == DRAWN for row in rows):
        for line, scenario in zip(
            lines, ["scenario", *(row.scenario for row in rows)], strict=True
        ):
            line.insert(2, scenario)
    return lines


def is_matrix(rows: Sequence[StressRow]) -> bool:
    """Return whether runs are to be shown by scenario: not those of sinusoids alone, nor draws."""
    if any(row.variant == DRAWN for row in rows):
        return False
    return len({row.label for row in rows}) > 1 or any(row.swing is not None for row in rows)


def matrix(rows: Sequence[StressRow], metric: Metric) -> list[list[str]]:
    """Return a metric as a table: a line per arm and controller, a column per case.

    The first line is the head. A run that was lost has the cell "lost". Columns in which no run has
    the metric are left out.

    Args:
        rows: runs, the cases of one arm and controller in any order.
        metric: what to show of a row, such as one of `METRICS`.
    """
    shown = {row.label: None for row in rows if metric(row) is not None}
    found = {(row.arm, row.controller, row.label): row for row in rows}
    lines = [["arm", "controller", *shown]]
    for arm, controller in dict.fromkeys((row.arm, row.controller) for row in rows):
        each = [found.get((arm, controller, label)) for label in shown]
        lines.append([arm, controller, *(_cell(row, metric) for row in each)])
    return lines if shown else []


def matrices(rows: Sequence[StressRow]) -> dict[str, list[list[str]]]:
    """Return the matrix of each metric that some run has, by title."""
    tables = {title: matrix(rows, metric) for title, metric in METRICS.items()}
    return {title: lines for title, lines in tables.items() if lines}


def turned(lines: Sequence[Sequence[str]]) -> list[list[str]]:
    """Return a matrix with a line per case and a column per arm; one controller goes unnamed."""
    one = len({line[1] for line in lines[1:]}) == 1
    names = [lines[0][0], *(line[0] if one else f"{line[0]} {line[1]}" for line in lines[1:])]
    names[0] = "scenario"
    return [names, *([*column] for column in zip(*(line[2:] for line in lines), strict=True))]


def markdown(rows: Iterable[StressRow]) -> str:
    """Return the rows as Markdown: one table, or a matrix for each metric, and what was run."""
    rows = [*rows]
    if not is_matrix(rows):
        lines = listing(rows)
        return markdown_table(lines[0], lines[1:], align="ll" + "r" * (len(lines[0]) - 2))
    parts = []
    for title, lines in matrices(rows).items():
        align = "ll" + "r" * (len(lines[0]) - 2)
        parts.append(
            f"## {title[0].upper()}{title[1:]}\n\n{markdown_table(lines[0], lines[1:], align)}"
        )
    texts = {(row.arm, row.label): row.text for row in rows}
    stated = [f"- {arm}, {label}: {text}" for (arm, label), text in texts.items() if text]
    if stated:
        parts.append("## What was run\n\n" + "\n".join(stated) + "\n")
    return "\n".join(parts)


def _cell(row: StressRow | None, metric: Metric) -> str:
    if row is None:
        return NONE
    if row.diverged:
        return "lost"
    value = metric(row)
    if value is None:
        return NONE
    return "never" if math.isinf(value) else _number(value)


def _scaled(value: float | None) -> float | None:
    return None if value is None else 1e3 * value


def _number(value: float) -> str:
    return "∞" if value == INFINITE else f"{value:.3g}" if value < 1000.0 else f"{value:.0f}"
