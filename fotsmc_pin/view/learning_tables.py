"""What was learnt of an arm, in words: for the terminal, files and reports."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.files import markdown_table
from fotsmc_pin.learning import recorded_estimates
from fotsmc_pin.view.prose import scrolling
from fotsmc_pin.view.report_tables import html_table

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fotsmc_pin.learning import Estimate, Estimates
    from fotsmc_pin.simulation import Recording

NAMES = {
    "link_scale": "mass and inertia",
    "link_moment": "first moment",
    "payload": "payload",
    "armature": "armature",
    "damping": "viscous friction",
    "friction": "Coulomb friction",
    "stribeck": "breakaway friction",
}
"""What a group of parameters is called."""
AXIS = "along "
"""What stands before the axis of a moment."""
HEAD = ("parameter", "of", "learnt", "nominal", "unit")


def name_of(row: Estimate) -> str:
    """Return what a parameter is called."""
    if row.group == "payload":
        return f"payload, {'mass' if row.of == 'mass' else 'first moment'}"
    return NAMES.get(row.group, row.group)


def owner_of(row: Estimate) -> str:
    """Return the link, joint or direction; of links that move as one, the first and a number.

    A link's moment is told with its direction.
    """
    if row.group == "payload":
        return "tool" if row.of == "mass" else row.of.removeprefix("moment ")
    links, axis = row.of.rsplit(" ", 1) if row.group == "link_moment" else (row.of, "")
    first, *others = links.split(" and ")
    owner = f"{first} and {len(others)} more" if others else first
    return f"{owner} {AXIS}{axis}" if axis else owner


def whole_name(name: str, owner: str) -> str:
    """Return name and owner of a parameter in one."""
    if owner == "tool":
        return name
    return f"{name} along {owner}" if name.startswith("payload") else f"{name} of {owner}"


def unit_of(row: Estimate) -> str:
    """Return the unit in which a parameter is told."""
    return row.unit or "× nominal"


def with_deviation(value: float, deviation: float) -> str:
    """Return `value ± deviation`, to two digits of the deviation."""
    if not deviation > 0.0:
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(deviation)))
    return f"{value:.{decimals}f} ± {deviation:.{decimals}f}"


def known_lines(estimates: Estimates) -> list[list[str]]:
    """Return a line of cells under `HEAD` for each parameter that is known."""
    return [
        [
            name_of(row),
            owner_of(row),
            with_deviation(row.value, row.deviation),
            f"{row.first_value:.4g}",
            unit_of(row),
        ]
        for row in estimates
        if row.known
    ]


def untold(estimates: Estimates) -> str:
    """Return which parameters the motion could not tell, as a sentence; empty for none.

    Those that were held fixed, as their deviation beforehand was 0, are no question.
    """
    asked = [row for row in estimates if row.first_deviation > 0.0]
    names = dict.fromkeys(name_of(row) for row in asked if not row.known)
    told = [_without([row for row in asked if name_of(row) == name]) for name in names]
    return f"The motion could not tell: {'; '.join(told)}." if told else ""


def _without(rows: Sequence[Estimate]) -> str:
    """Return name and owners of those of one kind that are not known."""
    name, group = name_of(rows[0]), rows[0].group
    if len(rows) > 1 and group != "payload" and not any(row.known for row in rows):
        return f"{name} of every {'link' if group.startswith('link') else 'joint'}"
    return whole_name(name, _joined([owner_of(row) for row in rows if not row.known]))


def _joined(owners: Sequence[str]) -> str:
    """Return owners with commas between them; directions of one link follow its name once."""
    shown: dict[str, list[str]] = {}
    for owner in owners:
        link, along, axis = owner.partition(f" {AXIS}")
        shown.setdefault(link, []).extend([axis] if along else [])
    return ", ".join(
        f"{link} {AXIS}{' and '.join(axes)}" if len(axes) in (1, 2) else link
        for link, axes in shown.items()
    )


def noticed(rec: Recording) -> str:
    """Return when the payload was found to be another, as words; empty where it never was."""
    changes = rec.signals.get("changes")
    if changes is None or not len(rec):
        return ""
    times = rec.t[1:][np.diff(changes[:, 0]) > 0.0].tolist()
    return ", ".join(f"{t:.2f} s" for t in times)


def learning_markdown(estimates: Estimates) -> str:
    """Return what is known as a Markdown table, and what the motion could not tell."""
    lines = known_lines(estimates)
    table = markdown_table(HEAD, lines, "llrrl") if lines else "Nothing is known yet.\n"
    missing = untold(estimates)
    return "# What was learnt\n\n" + table + (f"\n{missing}\n" if missing else "")


def learning_section(runs: Mapping[str, Recording]) -> str:
    """Return what was learnt in each run as HTML; empty where no run learns."""
    parts = []
    for name, rec in runs.items():
        estimates = recorded_estimates(rec)
        if estimates is None:
            continue
        head = f"<h3>{html.escape(name)}</h3>" if len(runs) > 1 else ""
        parts.append(head + _told(rec, estimates))
    return "".join(parts)


def _told(rec: Recording, estimates: Estimates) -> str:
    lines, found, times = known_lines(estimates), [], noticed(rec)
    found.append(f"At the end of the run, at {rec.t[-1]:g} s, ± one standard deviation.")
    if times:
        found.append(f"The payload was found to be another at {times}.")
    found.append(untold(estimates))
    words = "".join(f"<p>{html.escape(text)}</p>" for text in found if text)
    return (scrolling("Table of estimates", _table(lines)) if lines else "") + words


def _table(lines: Sequence[Sequence[str]]) -> str:
    """Return the table with parameter and owner in one cell, which names the row."""
    rows = (
        [whole_name(name, of), f"{learnt} {unit}", nominal]
        for name, of, learnt, nominal, unit in lines
    )
    return html_table(["parameter", "learnt", "nominal"], rows)
