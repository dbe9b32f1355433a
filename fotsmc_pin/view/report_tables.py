"""The tables of a report: metrics of the runs, and what was run."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.view.about_run import diverged_runs, lead, run_facts
from fotsmc_pin.view.prose import scrolling

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from fotsmc_pin.simulation import Recording

KINDS = {
    "rad": {"joints": "Revolute joints", "small": "mrad", "effort": "N·m", "what": "torque"},
    "m": {"joints": "Prismatic joints", "small": "mm", "effort": "N", "what": "force"},
}
"""Words and units of the metrics by the unit of the joints' position."""

COLUMNS: tuple[tuple[str, str, float], ...] = (
    ("settling_time", "settles to 10 {small} [s]", 1.0),
    ("settling_time_1_mrad", "to 1 {small} [s]", 1.0),
    ("tail_rms_error", "RMS error, last half [{small}]", 1e3),
    ("max_tail_error", "largest error, last half [{small}]", 1e3),
    ("max_error", "largest error, whole run [{small}]", 1e3),
    ("swing", "swing at rest [{small}]", 1e3),
    ("time_to_rest", "time to rest [s]", 1.0),
    ("peak_torque", "peak {what} [{effort}]", 1.0),
    ("tail_torque_variation", "{what} variation, last half [{effort}/s]", 1.0),
    ("chattering", "{what}'s power above 20 Hz [%]", 100.0),
    ("energy", "energy [J]", 1.0),
    ("saturation_fraction", "ticks at a limit [%]", 100.0),
    ("tail_rms_tool_error", "RMS tool error, last half [mm]", 1e3),
)
"""Metrics that a report tells: name, heading, and factor to the heading's unit."""
OF_REST = ("swing", "time_to_rest")
"""Metrics that say something only where the reference comes to rest."""


def heading(text: str, unit: str) -> str:
    """Return a heading of `COLUMNS` for joints whose position is in "rad" or "m"."""
    for name, word in KINDS[unit].items():
        text = text.replace(f"{{{name}}}", word)
    return text


def metrics_table(
    summaries: Mapping[str, Mapping[str, Mapping[str, Any]]], titles: Mapping[str, str]
) -> str:
    """Return the metrics of all runs as HTML: a table for each kind of joint, a row per run.

    Args:
        summaries: metrics by the name of the run and the unit of the joints' position.
        titles: what to call a run, where its name alone says too little.
    """
    units = [unit for unit in KINDS if any(unit in kinds for kinds in summaries.values())]
    tables = []
    for unit in units:
        rows = {name: kinds[unit] for name, kinds in summaries.items() if unit in kinds}
        known = [column for column in COLUMNS if _is_known(column[0], [*rows.values()])]
        table = html_table(
            ["run", *(heading(text, unit) for _, text, _ in known)],
            (
                [titles.get(name, name), *(number(row.get(key), by) for key, _, by in known)]
                for name, row in rows.items()
            ),
        )
        of = KINDS[unit]["joints"]
        head = f"<h3>{of}</h3>" if len(units) > 1 or unit == "m" else ""
        label = f"Table of metrics, {of.lower()}" if head else "Table of metrics"
        tables.append(head + scrolling(label, table))
    return "".join(tables)


def _is_known(key: str, rows: Sequence[Mapping[str, Any]]) -> bool:
    if key in OF_REST and not any(
        isinstance(row.get("time_to_rest"), float) and math.isfinite(row["time_to_rest"])
        for row in rows
    ):
        return False
    return any(key in row for row in rows)


def html_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as HTML; the first cell of a row names it. Text is escaped."""
    top = "".join(f'<th scope="col">{html.escape(cell)}</th>' for cell in head)
    body = "".join(
        f'<tr><th scope="row">{html.escape(name)}</th>'
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
        + "</tr>"
        for name, *cells in rows
    )
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def facts(runs: Mapping[str, Recording]) -> str:
    """Return what was run as HTML: a sentence and a list per run."""
    return "\n".join(
        f"<h3>{html.escape(name)}</h3><p>{html.escape(lead(rec))}</p>{definitions(run_facts(rec))}"
        for name, rec in runs.items()
    )


def divergences(runs: Mapping[str, Recording]) -> str:
    """Return, as HTML, which runs diverged, when and by which joint; empty where none did."""
    lines = [
        f"<p><strong>{html.escape(name)}</strong>: {html.escape(words)} "
        "Its metrics are those of the time before.</p>"
        for name, words in diverged_runs(runs)
    ]
    return f'<div class="warning" role="alert">{"".join(lines)}</div>' if lines else ""


def definitions(entries: Sequence[tuple[str, Sequence[str]]]) -> str:
    """Return names and the words under each as an HTML list."""
    rows = "".join(
        f"<dt>{html.escape(name)}</dt>"
        f"<dd>{''.join(f'<span>{html.escape(word)}</span>' for word in words)}</dd>"
        for name, words in entries
    )
    return f"<dl>{rows}</dl>"


def number(value: Any, scale: float = 1.0) -> str:
    """Return a metric to three digits; "never" where it is infinite."""
    if value is None:
        return "–"
    try:
        scaled = scale * float(value)
    except (TypeError, ValueError):
        return str(value)
    if math.isinf(scaled):
        return "never"
    return f"{scaled:.0f}" if abs(scaled) >= 1000.0 else f"{scaled:.3g}"
