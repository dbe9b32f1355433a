"""The tables of a report: figures of the runs, and what was run."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.view.prose import scrolling

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fotsmc_pin.simulation import Recording

COLUMNS: tuple[tuple[str, str, float], ...] = (
    ("settling_time", "settles to 10 mrad [s]", 1.0),
    ("settling_time_1_mrad", "to 1 mrad [s]", 1.0),
    ("tail_rms_error", "RMS error, last half [mrad]", 1e3),
    ("max_tail_error", "largest error, last half [mrad]", 1e3),
    ("peak_torque", "peak torque [N·m]", 1.0),
    ("tail_torque_variation", "torque variation, last half [N·m/s]", 1.0),
    ("chattering", "torque's power above 20 Hz [%]", 100.0),
    ("energy", "energy [J]", 1.0),
    ("saturation_fraction", "ticks at a torque limit [%]", 100.0),
)
"""Figures of `Summary` that a report tells: name, heading, and factor to the heading's unit."""

TOLD_APART = frozenset(
    ("controller", "preset", "gains", "nominal_arm", "dt", "duration", "wall_time", "versions")
)
"""Metadata that `run_facts` puts in words of its own; the rest is listed as it is."""


def metrics_table(summaries: Mapping[str, Mapping[str, Any]], titles: Mapping[str, str]) -> str:
    """Return the figures of all runs as HTML, a row per run."""
    known = [column for column in COLUMNS if any(column[0] in s for s in summaries.values())]
    head = "".join(f'<th scope="col">{html.escape(heading)}</th>' for _, heading, _ in known)
    rows = [
        f'<tr><th scope="row">{html.escape(titles.get(name, name))}</th>'
        + "".join(f"<td>{_number(summary.get(key), scale)}</td>" for key, _, scale in known)
        + "</tr>"
        for name, summary in summaries.items()
    ]
    return scrolling(
        "Table of metrics",
        f'<table><thead><tr><th scope="col">run</th>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table>",
    )


def facts(runs: Mapping[str, Recording]) -> str:
    """Return what was run as HTML, a list per run."""
    return "\n".join(
        f"<h3>{html.escape(name)}</h3><dl>{_entries(run_facts(rec))}</dl>"
        for name, rec in runs.items()
    )


def run_facts(rec: Recording) -> list[tuple[str, list[str]]]:
    """Return what a recording tells of its run: names, and the words under each."""
    told = rec.metadata
    arm = rec.arm
    entries: list[tuple[str, Any]] = [
        ("true arm", f"{arm.name}, {arm.nv} joints: {', '.join(arm.joint_names)}"),
        ("what differs", list(arm.changes)),
        ("on loading", list(arm.notes)),
        ("nominal arm", told.get("nominal_arm")),
        ("controller", told.get("controller")),
        ("preset", told.get("preset")),
        ("gains", [f"{name} = {_text(value)}" for name, value in told.get("gains", {}).items()]),
        ("tick", f"{1e3 * told['dt']:g} ms" if "dt" in told else None),
        ("duration", f"{told['duration']:g} s" if "duration" in told else None),
        *((name.replace("_", " "), _text(told[name])) for name in told if name not in TOLD_APART),
        ("took", f"{told['wall_time']:.2f} s" if "wall_time" in told else None),
        ("versions", [f"{name} {text}" for name, text in told.get("versions", {}).items()]),
    ]
    return [
        (name, value if isinstance(value, list) else [str(value)])
        for name, value in entries
        if value not in (None, "", [])
    ]


def _entries(entries: Sequence[tuple[str, Sequence[str]]]) -> str:
    return "".join(
        f"<dt>{html.escape(name)}</dt>"
        f"<dd>{''.join(f'<span>{html.escape(word)}</span>' for word in words)}</dd>"
        for name, words in entries
    )


def _number(value: Any, scale: float) -> str:
    if value is None:
        return "–"
    try:
        number = scale * float(value)
    except (TypeError, ValueError):
        return html.escape(str(value))
    if math.isinf(number):
        return "never"
    return f"{number:.0f}" if abs(number) >= 1000.0 else f"{number:.3g}"


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(_text(item) for item in value)
    return str(value)
