"""`write_identification`: what identification found, as one offline page."""

from __future__ import annotations

import html
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.files import write_text
from fotsmc_pin.view.figures import LIMIT
from fotsmc_pin.view.palette import BLUE, GREY, VERMILLION
from fotsmc_pin.view.prose import scrolling
from fotsmc_pin.view.report import filled
from fotsmc_pin.view.report_figures import drawn_bytes, gallery
from fotsmc_pin.view.report_tables import html_table
from fotsmc_pin.view.style import label_time, legend_above, new_figure, paper_style

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from fotsmc_pin.identification import Identification, IdentifiedParameter, TorqueCheck

SHOWN = 10.0
"""Length of a log that the curves show [s]."""
NAMES = {
    "mass": "mass",
    "first moment": "first moment",
    "inertia": "inertia about the joint",
    "armature": "armature",
    "damping": "viscous friction",
    "friction": "Coulomb friction",
    "offset": "offset",
    "stribeck": "breakaway friction",
}
"""What a group of parameters is called."""
TORQUE_HEAD = ("joint", "error", "noise", "error / noise", "nominal", "torque", "unit")
HEAD = ("parameter", "identified", "95 % from", "to", "nominal", "unit", "known")


def write_identification(result: Identification, path: str | os.PathLike[str]) -> Path:
    """Write one HTML file about an identification; it holds everything and fetches nothing.

    Measured against predicted torque of every log, joint by joint; its errors beside the noise and
    beside those of the nominal arm; the parameters and base parameters with their confidence
    intervals; and in words what could not be told.

    Args:
        result: what `identify` returned.
        path: file to write, whole or not at all.

    Returns:
        The path that was written.

    Raises:
        OSError: the file cannot be written.
    """
    told = sum(row.known for row in result.base_parameters)
    sections = {
        "Torque of the logs": _torque(result, result.fits),
        "Torque of other logs": _torque(result, result.validation),
        "What could not be told": _sentences((*result.unidentifiable, *result.notes)),
        "Parameters of the joints": _parameters(result, own=True),
        "Base parameters": scrolling("Base parameters", base_table(result.base_parameters)),
        "Parameters of the bodies": _parameters(result, own=False),
    }
    subtitle = f"identified from {', '.join(check.label for check in result.fits)}: " + (
        f"{told} of {len(result.base_parameters)} base parameters known"
    )
    write_text(path, filled(result.nominal.name, subtitle, sections))
    return Path(path)


def torque_rows(result: Identification, check: TorqueCheck) -> list[tuple[str, ...]]:
    """Return a row of words per joint, as `TORQUE_HEAD` names them."""
    return [
        (
            name,
            f"{check.error[j]:.3g}",
            f"{check.floor[j]:.3g}",
            f"{check.error[j] / max(check.floor[j], 1e-12):.2f}",
            f"{check.nominal_error[j]:.3g}",
            f"{check.torque[j]:.3g}",
            result.arm.effort_units[j],
        )
        for j, name in enumerate(result.arm.joint_names)
    ]


def parameter_words(row: IdentifiedParameter) -> tuple[str, ...]:
    """Return value, interval, nominal value, unit, and whether it is known, in words."""
    low, high = row.interval
    numbers = (row.value, low, high, row.nominal)
    return (*(f"{number:.4g}" for number in numbers), row.unit, "yes" if row.known else "no")


def base_table(rows: Sequence[IdentifiedParameter]) -> str:
    """Return the base parameters as an HTML table."""
    return html_table(HEAD, [(row.of, *parameter_words(row)) for row in rows])


def torque_figure_of(result: Identification, check: TorqueCheck) -> Figure:
    """Return measured and predicted torque of each joint, and what is left, over some seconds."""
    n = result.arm.nv
    figure, axes = new_figure(n, 2, width="page", row_height=1.1)
    rows = check.t <= check.t[0] + SHOWN
    with paper_style():
        for j, name in enumerate(result.arm.joint_names):
            left, right = axes[j]
            unit = result.arm.effort_units[j]
            t = check.t[rows]
            left.plot(t, check.measured[rows, j], color=GREY, lw=1.8, label="measured")
            left.plot(t, check.by_nominal[rows, j], color=VERMILLION, lw=0.6, label="nominal arm")
            left.plot(t, check.predicted[rows, j], color=BLUE, lw=0.8, label="identified arm")
            left.set_ylabel(f"{name}\n[{unit}]", fontsize=6)
            missed = np.where(check.used, check.measured - check.predicted, np.nan)
            right.plot(t, missed[rows, j], color=BLUE, lw=0.6)
            right.axhline(0.0, **LIMIT)
            right.set_ylabel(f"residual [{unit}]", fontsize=6)
        label_time(axes)
        legend_above(figure, axes[0, 0])
    return figure


def _torque(result: Identification, checks: Sequence[TorqueCheck]) -> str:
    parts = []
    for check in checks:
        table = html_table(TORQUE_HEAD, torque_rows(result, check))
        picture = gallery(
            [(f"torque of {check.label}", drawn_bytes(torque_figure_of(result, check)))]
        )
        parts.append(
            f"<h3>{html.escape(check.label)}</h3>"
            "<p>RMS of measured minus predicted torque where a joint moves, sample by sample; the "
            "noise is what no smooth torque explains. Torque was recorded "
            f"{1e3 * check.delay:.2g} ms after the motion. The curves are averages over some "
            "hundredths of a second.</p>"
            f"{scrolling('Errors of the torque', table)}{picture}"
        )
    return "".join(parts)


def _parameters(result: Identification, *, own: bool) -> str:
    bodies = ("mass", "first moment", "inertia")
    rows = [
        (f"{NAMES[row.group]}, {row.of}", *parameter_words(row))
        for row in result.parameters
        if (row.group in bodies) != own
    ]
    label = "Parameters of the joints" if own else "Parameters of the bodies"
    words = (
        ""
        if own
        else "<p>Of the body behind each joint, about the joint's origin. Most are told only in "
        "the sums above; what the logs leave open stands as the nominal file has it.</p>"
    )
    return words + scrolling(label, html_table(HEAD, rows))


def _sentences(lines: Sequence[str]) -> str:
    return "".join(f"<p>{html.escape(line)}</p>" for line in lines)
