"""What a notebook shows of an arm, a controller, a recording or a summary: HTML, offline."""

from __future__ import annotations

import html
from functools import singledispatch

import numpy as np

from fotsmc_pin.analysis import Summary
from fotsmc_pin.analysis.metrics import value_with_unit
from fotsmc_pin.arms import Arm
from fotsmc_pin.control import Controller
from fotsmc_pin.simulation import Recording
from fotsmc_pin.view.about_run import divergence_words, lead, payloads, plain
from fotsmc_pin.view.report import framed
from fotsmc_pin.view.report_tables import definitions, html_table


@singledispatch
def shown(thing: object) -> str:
    """Return a thing as HTML; of what has no HTML of its own, its `repr`."""
    return f"<pre>{html.escape(repr(thing))}</pre>"


@shown.register
def _(arm: Arm) -> str:
    """Show an arm as a table of its joints, with what was done to it."""

    def limit(value: float, unit: str) -> str:
        return f"{value:.4g} {unit}" if np.isfinite(value) else "–"

    rows = [
        (
            name,
            "prismatic" if unit == "m" else "revolute",
            f"{limit(low, unit)} … {limit(high, unit)}",
            limit(speed, f"{unit}/s"),
            limit(effort, effort_unit),
        )
        for name, unit, effort_unit, low, high, speed, effort in zip(
            arm.joint_names,
            arm.position_units,
            arm.effort_units,
            arm.lower_position_limit,
            arm.upper_position_limit,
            arm.velocity_limit,
            arm.effort_limit,
            strict=True,
        )
    ]
    told = [
        ("tool frame", [arm.tool_frame]),
        ("payload", [words.removeprefix("payload ") for words in payloads(arm)]),
    ]
    told += [("changed", [*arm.changes]), ("on loading", [*arm.notes])]
    table = html_table(["joint", "kind", "position", "speed limit", "effort limit"], rows)
    known = [(name, words) for name, words in told if words]
    return f"<p><strong>{html.escape(arm.name)}</strong></p>{table}{definitions(known)}"


@shown.register
def _(controller: Controller) -> str:
    """Show a controller as a table of its gains with their units."""
    declared = type(controller.gains).__dataclass_fields__
    rows = [
        (name, plain(value), declared[name].metadata.get("unit", "") or "–")
        for name, value in controller.gains.as_dict().items()
    ]
    head = f"{type(controller).__name__} for {controller.arm.name}"
    preset = f", preset {controller.preset}" if controller.preset else ""
    about = f"every {1e3 * controller.dt:g} ms{preset}"
    table = html_table(["gain", "value", "unit"], rows)
    return f"<p><strong>{html.escape(head)}</strong>, {html.escape(about)}</p>{table}"


@shown.register
def _(recording: Recording) -> str:
    """Show a recording as its page, in a frame that can do nothing but run its own scripts."""
    if not len(recording):
        return f"<pre>{html.escape(repr(recording))}</pre>"
    lost = divergence_words(recording)
    warning = f"<p><strong>{html.escape(lost)}</strong></p>" if lost else ""
    frame = framed(recording).replace(
        "<iframe ", '<iframe style="width:100%;height:620px;border:1px solid #8888" ', 1
    )
    return f"{warning}<p>{html.escape(lead(recording))}</p>{frame}"


@shown.register
def _(summary: Summary) -> str:
    """Show a summary as a table of values with units."""
    rows = [
        (name, value_with_unit(value, summary.units[name]))
        for name, value in summary.as_dict().items()
    ]
    return html_table(["metric", "value"], rows)
