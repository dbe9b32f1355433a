"""What `fotsmc simulate` leaves and prints: the run, its metrics, figure and page, and a table."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fotsmc_pin.cli.output import file_name, show_table
from fotsmc_pin.cli.run_learnt import keep_learnt

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from fotsmc_pin.analysis import Summary
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.learning import ModelLearning
    from fotsmc_pin.simulation import Recording

SMALL = {"rad": "mrad", "m": "mm"}
EFFORT = {"rad": "N·m", "m": "N"}
KIND = {"rad": "turning:", "m": "sliding:"}


@dataclass(frozen=True, kw_only=True, eq=False)
class Told:
    """What was run, for the table."""

    nominal: Arm
    controller: Controller[Any] | ModelLearning
    reference: str
    true: str | None
    disturbance: str
    noise: float
    delay: int
    start_error: float


def keep_results(rec: Recording, told: Told, folder: Path) -> Path:
    """Write a run with its metrics, figure and page into a folder, print the table, warn.

    Returns:
        The page.
    """
    from fotsmc_pin import export_html, plot
    from fotsmc_pin.analysis import summarize, summarize_by_unit, tool_errors
    from fotsmc_pin.files import write_json

    summary, by_unit = summarize(rec), summarize_by_unit(rec)
    tool = tool_errors(rec)
    at_tool = {
        "tail_rms_tool_error": float((tool @ tool / len(tool)) ** 0.5),
        "max_tail_tool_error": float(tool.max()),
    }
    kinds = {unit: part.as_dict() for unit, part in by_unit.items()} if len(by_unit) > 1 else {}
    rec.save(folder / "run.npz", progress=True)
    metrics = summary.as_dict() | at_tool
    write_json(folder / "metrics.json", metrics | ({"by_unit": kinds} if kinds else {}))
    plot(rec, folder / "run.png")
    page = folder / f"{file_name(told.nominal.name)}.html"
    export_html(rec, page, progress=True)
    is_task = getattr(told.controller, "follows_poses", False)
    # Of a task the joints have no error of their own: what counts is that of the tool.
    rows = [*_run_rows(rec, told), *_metric_rows(rec, by_unit)[2 if is_task else 0 :]]
    rows.append(
        (
            "tool error, last half",
            f"{1e3 * at_tool['tail_rms_tool_error']:.4g} mm RMS, "
            f"{1e3 * at_tool['max_tail_tool_error']:.4g} mm at most",
        )
    )
    rows += [_turn_row(rec)] if is_task else []
    rows.append(("ticks at an effort limit", f"{100 * summary.saturation_fraction:.3g} %"))
    show_table(told.nominal.name, rows)
    keep_learnt(rec, told.controller, folder)
    if not is_task:
        _warn_where_unsettled(rec, by_unit)
    return page


def _turn_row(rec: Recording) -> tuple[str, str]:
    import numpy as np

    from fotsmc_pin.analysis import pose_errors

    turn = 1e3 * np.linalg.norm(pose_errors(rec, slice(len(rec) // 2, None))[:, 3:], axis=1)
    rms = float((turn @ turn / len(turn)) ** 0.5)
    return "tool turned off, last half", f"{rms:.4g} mrad RMS, {turn.max():.4g} mrad at most"


def _run_rows(rec: Recording, told: Told) -> list[tuple[str, str]]:
    from fotsmc_pin.view.marks import marks_of

    controller = told.controller
    changes = [*rec.arm.changes] if told.true is None else [told.true, *rec.arm.changes]
    unit = ", ".join(dict.fromkeys(rec.arm.position_units))
    conditions = [
        f"start error {told.start_error:g} {unit}" if told.start_error else "",
        f"disturbance {told.disturbance}" if told.disturbance != "none" else "",
        f"noise {told.noise:g} {unit}" if told.noise else "",
        f"delay {told.delay} {'tick' if told.delay == 1 else 'ticks'}" if told.delay else "",
    ]
    seconds, tick = rec.t[-1] - rec.t[0], 1e3 * controller.dt
    rows = [
        ("law", f"{rec.metadata['controller']}, preset {controller.preset}"),
        ("reference", f"{told.reference}; {seconds:.4g} s, ticks of {tick:g} ms"),
        ("nominal arm", f"{told.nominal.name}, {told.nominal.nv} joints"),
        ("true arm", "; ".join(changes) or "as the nominal arm"),
    ]
    rows += [("conditions", shown)] if (shown := "; ".join(filter(None, conditions))) else []
    happens = "\n".join(mark.told for mark in marks_of([rec]))
    return [*rows, ("happens", happens)] if happens else rows


def _metric_rows(rec: Recording, by_unit: Mapping[str, Summary]) -> list[tuple[str, str]]:
    """Return the metrics; of an arm whose joints turn and slide, a line for each kind."""
    from fotsmc_pin.analysis import reference_stop

    def lines(value: Callable[[str, Summary], str]) -> str:
        return "\n".join(
            (f"{KIND[unit]} " if len(by_unit) > 1 else "") + value(unit, summary)
            for unit, summary in by_unit.items()
        )

    what = "torque" if "m" not in by_unit else "force" if "rad" not in by_unit else "effort"
    rows = [
        (
            f"settles to 10 {' or '.join(SMALL[unit] for unit in by_unit)}",
            lines(lambda unit, summary: _time(summary.settling_time)),
        ),
        (
            "error, last half",
            lines(
                lambda unit, summary: (
                    f"{1e3 * summary.tail_rms_error:.4g} {SMALL[unit]} RMS, "
                    f"{1e3 * summary.max_tail_error:.4g} {SMALL[unit]} at most"
                )
            ),
        ),
        (
            f"peak {what}",
            lines(lambda unit, summary: f"{summary.peak_torque:.4g} {EFFORT[unit]}"),
        ),
        (
            f"{what} variation, last half",
            lines(lambda unit, summary: f"{summary.tail_torque_variation:.4g} {EFFORT[unit]}/s"),
        ),
    ]
    if reference_stop(rec) is not None:
        rows += [
            (
                "largest swing at rest",
                lines(lambda unit, summary: f"{1e3 * summary.swing:.4g} {SMALL[unit]}"),
            ),
            ("time to rest", lines(lambda unit, summary: _time(summary.time_to_rest))),
        ]
    return rows


def _time(seconds: float) -> str:
    return "never" if math.isinf(seconds) else f"{seconds:.3f} s"


def _warn_where_unsettled(rec: Recording, by_unit: dict[str, Summary]) -> None:
    """Warn of the joint that is farthest off where the run never settled."""
    for unit, summary in by_unit.items():
        if math.isfinite(summary.settling_time):
            continue
        ours = [j for j, other in enumerate(rec.arm.position_units) if other == unit]
        tail = rec.t >= 0.5 * (rec.t[0] + rec.t[-1])
        worst = max(ours, key=lambda j: float(abs(rec.e[tail, j]).max()))
        error = 1e3 * float(abs(rec.e[tail, worst]).max())
        warnings.warn(
            f"the run did not settle to 10 {SMALL[unit]}: {rec.arm.joint_names[worst]} was up to "
            f"{error:.4g} {SMALL[unit]} off in the last half",
            stacklevel=2,
        )
