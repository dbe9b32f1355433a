"""Figures of runs for papers: tracking, torque, surfaces, signals, and runs against each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.checks import choice
from fotsmc_pin.view.curves import thinned_curves
from fotsmc_pin.view.marks import mark_axes
from fotsmc_pin.view.palette import BLACK, COLORS, GREY
from fotsmc_pin.view.style import label_axis, label_time, legend_above, new_figure, paper_style

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array


POINTS_AT_MOST = 4000
INSET_WIDTH, INSET_HEIGHT = 0.54, 0.46
REFERENCE: dict[str, Any] = {"color": BLACK, "linestyle": (0, (4, 2)), "linewidth": 0.9}
LIMIT: dict[str, Any] = {"color": GREY, "linestyle": (0, (1, 1.5)), "linewidth": 0.9}


def tracking_figure(recording: Recording, joints: Sequence[int] | None = None) -> Figure:
    """Position with its reference on the left, tracking error on the right; a row per joint.

    The error's inset shows the second half of the run in a thousandth of the unit, so that what is
    left after settling can be read.
    """
    joints = _joints(recording, joints)
    figure, axes = new_figure(len(joints), 2, width="page")
    reference = reference_positions(recording)
    position = reference + recording.e
    with paper_style():
        for (left, right), joint in zip(axes, joints, strict=True):
            unit = recording.arm.position_units[joint]
            draw(left, recording.t, position[:, joint], label="arm")
            draw(left, recording.t, reference[:, joint], label="reference", **REFERENCE)
            label_axis(left, f"{_name(recording, joint)}", unit)
            draw(right, recording.t, recording.e[:, joint])
            label_axis(right, "error", unit)
            error_inset(right, recording.t, recording.e[:, joint], unit)
        axes[0, 0].legend(loc="best")
        label_time(axes)
        mark_axes(axes, [recording])
    return figure


def velocity_figure(recording: Recording, joints: Sequence[int] | None = None) -> Figure:
    """Velocity with its reference on the left, velocity error on the right; a row per joint."""
    joints = _joints(recording, joints)
    figure, axes = new_figure(len(joints), 2, width="page")
    with paper_style():
        for (left, right), joint in zip(axes, joints, strict=True):
            unit = f"{recording.arm.position_units[joint]}/s"
            draw(left, recording.t, recording.v[:, joint], label="arm")
            draw(left, recording.t, recording.v_d[:, joint], label="reference", **REFERENCE)
            label_axis(left, _name(recording, joint), unit)
            draw(right, recording.t, recording.e_dot[:, joint])
            label_axis(right, "velocity error", unit)
        axes[0, 0].legend(loc="best")
        label_time(axes)
        mark_axes(axes, [recording])
    return figure


def torque_figure(recording: Recording, joints: Sequence[int] | None = None) -> Figure:
    """Torque of each joint in a row of its own, with its limits."""
    joints = _joints(recording, joints)
    figure, axes = new_figure(len(joints), 1)
    with paper_style():
        for (panel,), joint in zip(axes, joints, strict=True):
            draw(panel, recording.t, recording.tau[:, joint], linewidth=0.8)
            label_axis(panel, _name(recording, joint), recording.arm.effort_units[joint])
            draw_limits(panel, recording, joint)
        label_time(axes)
        mark_axes(axes, [recording])
    return figure


def signal_figure(
    recording: Recording,
    name: str = "s",
    *,
    unit: str = "–",
    joints: Sequence[int] | None = None,
    reference: float | None = None,
    labels: Sequence[tuple[str, str]] | None = None,
) -> Figure:
    """One of the controller's signals, such as its sliding variable or an estimate; rows by joint.

    Args:
        recording: the run.
        name: key into `recording.signals`.
        unit: what stands in the axis' brackets.
        joints: which columns; None takes all.
        reference: a value to mark by a dashed line, such as the true one of an estimate.
        labels: what stands beside each column's axis, as (quantity, unit), in place of `unit` and
            the signal's own name.
    """
    table = recording.signals[name]
    columns = range(table.shape[1]) if joints is None else joints
    figure, axes = new_figure(len(columns), 1)
    with paper_style():
        for (panel,), column in zip(axes, columns, strict=True):
            if reference is not None:
                panel.axhline(reference, **REFERENCE)
            draw(panel, recording.t, table[:, column], linewidth=0.8)
            if labels is None:
                column_name = f"{name}, {_column_name(recording, table, column)}"
                label_axis(panel, column_name if table.shape[1] > 1 else name, unit)
            else:
                label_axis(panel, *labels[column])
        label_time(axes)
        mark_axes(axes, [recording])
    return figure


def overview_figure(recording: Recording) -> Figure:
    """Error, torque and sliding variable of all joints, in a panel for each unit."""
    arm = recording.arm
    panels = []
    for quantity, table, units in (
        ("error", recording.e, arm.position_units),
        ("torque", recording.tau, arm.effort_units),
    ):
        for unit in dict.fromkeys(units):
            name = "force" if unit == "N" else quantity
            panels.append((name, table, unit, [j for j, u in enumerate(units) if u == unit]))
    if "s" in recording.signals:
        table = recording.signals["s"]
        panels.append(("s", table, "–", list(range(table.shape[1]))))
    figure, axes = new_figure(len(panels), 1, width="page")
    with paper_style():
        for (panel,), (quantity, table, unit, columns) in zip(axes, panels, strict=True):
            for column in columns:
                label = _column_name(recording, table, column)
                draw(panel, recording.t, table[:, column], label=label, **line_style(column))
            label_axis(panel, quantity, unit)
        if arm.nv > 1:
            legend_above(figure, *(row[0] for row in axes))
        label_time(axes)
        mark_axes(axes, [recording])
    return figure


def comparison_figure(
    recordings: Mapping[str, Recording],
    joints: Sequence[int] | None = None,
    quantities: Sequence[str] = ("error", "torque"),
) -> Figure:
    """Several runs in common axes: a row per joint, a column per quantity.

    Args:
        recordings: name -> run; all of arms with the same joints.
        joints: which joints; None takes all.
        quantities: out of "error", "velocity error" and "torque".
    """
    first = next(iter(recordings.values()))
    joints = _joints(first, joints)
    figure, axes = new_figure(len(joints), len(quantities), width="page")
    with paper_style():
        for row, joint in zip(axes, joints, strict=True):
            for panel, quantity in zip(row, quantities, strict=True):
                for index, (name, recording) in enumerate(recordings.items()):
                    values = _quantity(recording, quantity)[:, joint]
                    draw(panel, recording.t, values, label=name, **line_style(index))
                label_axis(panel, quantity, _quantity_unit(first, quantity, joint))
                if quantity == "torque":
                    draw_limits(panel, first, joint)
            row[0].set_title(_name(first, joint), loc="left")
        legend_above(figure, axes[0, 0])
        label_time(axes)
        mark_axes(axes, recordings.values())
    return figure


def _quantity(recording: Recording, quantity: str) -> Array:
    tables = {"error": recording.e, "velocity error": recording.e_dot, "torque": recording.tau}
    return tables[choice("quantities", quantity, [*tables])]


def _quantity_unit(recording: Recording, quantity: str, joint: int) -> str:
    if quantity == "torque":
        return recording.arm.effort_units[joint]
    unit = recording.arm.position_units[joint]
    return f"{unit}/s" if quantity == "velocity error" else unit


def draw(axes: Axes, t: Array, values: Array, **style: Any) -> None:
    """Draw a curve over time, thinned so that a vector file stays small but peaks stay."""
    times, columns = thinned_curves(t, values[:, None], POINTS_AT_MOST)
    axes.plot(times, columns[:, 0], **style)
    axes.set_xlim(float(t[0]), float(t[-1]) if t[-1] > t[0] else float(t[0]) + 1.0)


def error_inset(axes: Axes, t: Array, error: Array, unit: str) -> Axes:
    """Add an inset with the second half of an error in thousandths of its unit."""
    bottom = 0.42 if abs(error.max()) >= abs(error.min()) else 0.16
    inset: Axes = axes.inset_axes((0.43, bottom, INSET_WIDTH, INSET_HEIGHT))
    tail = t >= t[0] + 0.5 * (t[-1] - t[0])
    draw(inset, t[tail], 1e3 * error[tail], linewidth=0.7)
    inset.tick_params(labelsize=6)
    inset.set_title(f"2nd half [m{unit}]" if unit == "rad" else "2nd half [mm]", fontsize=6, pad=2)
    return inset


def draw_limits(axes: Axes, recording: Recording, joint: int) -> None:
    """Mark the limits of a joint's torque; those far outside the curves are told, not drawn."""
    limit = float(recording.arm.effort_limit[joint])
    if not np.isfinite(limit):
        return
    if limit <= 2.5 * float(np.abs(recording.tau[:, joint]).max(initial=0.0)):
        for sign in (1, -1):
            axes.axhline(sign * limit, **LIMIT)
    text = f"limit ±{limit:g} {recording.arm.effort_units[joint]}"
    axes.set_title(text, loc="right", fontsize=6.5, color=GREY, pad=2)


def line_style(index: int) -> dict[str, Any]:
    """Return colour and dashes of a line; after the last colour the dashes change."""
    dashes: tuple[object, ...] = ("-", (0, (5, 1.5)), (0, (3, 1, 1, 1)), (0, (1, 1)))
    return {
        "color": COLORS[index % len(COLORS)],
        "linestyle": dashes[index // len(COLORS) % len(dashes)],
    }


def reference_positions(recording: Recording) -> Array:
    """Return the reference as one angle or travel per joint (N, nv) [rad, m], without jumps."""
    arm = recording.arm
    if arm.is_euclidean:
        return recording.q_d
    angles = np.array([arm.to_joint_positions(q) for q in recording.q_d])
    return np.unwrap(angles, axis=0)


def _joints(recording: Recording, joints: Sequence[int] | None) -> Sequence[int]:
    return range(recording.arm.nv) if joints is None else joints


def _name(recording: Recording, joint: int) -> str:
    return recording.arm.joint_names[joint].replace("$", r"\$")


def _column_name(recording: Recording, table: Array, column: int) -> str:
    same = table.shape[1] == recording.arm.nv
    return _name(recording, column) if same else f"[{column}]"
