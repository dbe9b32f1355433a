"""What a report tells of many runs: how their metrics are spread, and which was the worst."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.evaluation.studies import StudyResult
from fotsmc_pin.view.about_run import counted, flat, spaced
from fotsmc_pin.view.many_runs import distribution_figure
from fotsmc_pin.view.prose import scrolling
from fotsmc_pin.view.report_tables import COLUMNS, definitions, heading, html_table, number

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from matplotlib.figure import Figure

SPREAD = (
    "tail_rms_error",
    "max_tail_error",
    "settling_time",
    "peak_torque",
    "tail_torque_variation",
)
"""Metrics whose quantiles a report of many runs tells."""
DRAWN = ("tail_rms_error", "max_tail_error", "settling_time")
JUDGED = "tail_rms_error"
"""The metric by which a report calls a run the worst."""
GROUPS_AT_MOST = 7
LEVELS = (0.05, 0.5, 0.95, 1.0)
FAILURES_AT_MOST = 5


def study_words(study: StudyResult) -> str:
    """Return how many runs a study has, and how many of them failed."""
    failed = f", {len(study.failed)} failed" if study.failed else ""
    return f"study of {counted(len(study), 'run')}{failed}"


def stress_words(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return how many runs a stress suite has, of what, and how many of them diverged."""
    laws, arms = ({row.get(key) for row in rows} for key in ("controller", "arm"))
    scenarios = {row.get("scenario") for row in rows}
    several = f" in {counted(len(scenarios), 'scenario')}" if len(scenarios) > 1 else ""
    lost = sum(bool(row.get("diverged")) for row in rows)
    diverged = f", {lost or 'none'} diverged"
    return (
        f"stress suite of {counted(len(rows), 'run')}: {counted(len(laws), 'controller')} on "
        f"{counted(len(arms), 'arm')}{several}{diverged}"
    )


def groups_of(study: StudyResult) -> dict[str, StudyResult]:
    """Return the runs that succeeded, by the parameters that take few values.

    A grid repeats its values; what was drawn for each run differs from run to run.
    """
    values: dict[str, set[str]] = {}
    for row in study.succeeded:
        for name, value in row.parameters.items():
            values.setdefault(name, set()).add(repr(value))
    most = min(GROUPS_AT_MOST, len(study.succeeded) // 2)
    grid = [name for name, found in values.items() if 1 < len(found) <= most]
    rows: dict[str, list[Any]] = {}
    for row in study.succeeded:
        name = ", ".join(f"{key} {row.parameters.get(key)}" for key in grid) or "all runs"
        rows.setdefault(name, []).append(row)
    if len(rows) > GROUPS_AT_MOST:
        return {"all runs": StudyResult(study.succeeded)}
    return {name: StudyResult(tuple(members)) for name, members in sorted(rows.items())}


def study_section(study: StudyResult) -> str:
    """Return quantiles of the metrics, the worst run and the failures of a study as HTML."""
    parts = []
    if study.succeeded:
        parts += [_quantiles(groups_of(study)), _worst(study)]
    failures = [
        f"<li>{html.escape(_parameters(row.parameters))}, seed {row.seed}: "
        f"{html.escape(str(row.error))}</li>"
        for row in study.failed[:FAILURES_AT_MOST]
    ]
    if failures:
        shown = (
            f", the first {FAILURES_AT_MOST} of them" if len(study.failed) > len(failures) else ""
        )
        count = counted(len(study.failed), "run")
        parts.append(f"<h3>{count} failed{shown}</h3><ul>{''.join(failures)}</ul>")
    return "".join(parts)


def _quantiles(groups: Mapping[str, StudyResult]) -> str:
    known = next(iter(groups.values())).succeeded[0].metrics
    rows = [
        [
            heading(text, "rad"),
            name,
            str(len(group)),
            *_numbers(group.quantiles(key, LEVELS), scale),
        ]
        for key, text, scale in COLUMNS
        if key in SPREAD and key in known
        for name, group in groups.items()
    ]
    head = ["metric", "runs of", "runs", "5 %", "median", "95 %", "worst"]
    return scrolling("Quantiles of the metrics", html_table(head, rows))


def _worst(study: StudyResult) -> str:
    row = study.worst(JUDGED)
    told = [
        ("parameters", [_parameters(row.parameters)]),
        ("seed", [str(row.seed)]),
        *(
            (heading(text, "rad"), [number(row.metrics[key], scale)])
            for key, text, scale in COLUMNS
            if key in SPREAD and key in row.metrics
        ),
    ]
    return f"<h3>The worst run, by its RMS error</h3>{definitions(told)}"


def _parameters(parameters: Mapping[str, Any]) -> str:
    return ", ".join(f"{spaced(k)} {' '.join(flat(v))}" for k, v in parameters.items()) or "none"


def _numbers(values: Iterable[float], scale: float) -> list[str]:
    return [number(value, scale) for value in values]


def stress_section(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the worst run of a stress suite as HTML."""
    row = max(rows, key=lambda row: np.nan_to_num(_value(row, JUDGED), nan=np.inf, posinf=np.inf))
    error = _value(row, JUDGED)
    seed = f", seed {row['seed']}" if "seed" in row else ""
    case = " ".join(str(row[key]) for key in ("scenario", "variant") if row.get(key))
    scenario = f", scenario {case}" if case else ""
    words = f"{row.get('controller')} on {row.get('arm')}{scenario}{seed}"
    outcome = (
        "it diverged"
        if row.get("diverged")
        else f"RMS error {number(error, 1e3)} mrad over the last half"
    )
    return f"<p>The worst run: {html.escape(words)}: {html.escape(outcome)}.</p>"


def _value(row: Mapping[str, Any], key: str) -> float:
    try:
        return float(row.get(key, np.nan))
    except (TypeError, ValueError):
        return np.nan


def many_run_figures(
    study: StudyResult | None, stress: Sequence[Mapping[str, Any]]
) -> list[tuple[str, Figure]]:
    """Return how the metrics of a study or of a stress suite are spread, as named figures."""
    if study is not None and study.succeeded:
        groups = groups_of(study)
        known = study.succeeded[0].metrics
        tables = {
            key: {name: group.metric(key) for name, group in groups.items()}
            for key in DRAWN
            if key in known
        }
    else:
        by_law: dict[str, list[Mapping[str, Any]]] = {}
        for row in stress:
            by_law.setdefault(str(row.get("controller")), []).append(row)
        if not by_law or len(by_law) > GROUPS_AT_MOST or len(stress) < 3 * len(by_law):
            return []
        tables = {
            key: {law: np.array([_value(row, key) for row in rows]) for law, rows in by_law.items()}
            for key in DRAWN
        }
    texts = {key: (text, scale) for key, text, scale in COLUMNS}
    figures = []
    for key, groups_values in tables.items():
        text, scale = texts[key]
        quantity, _, unit = heading(text, "rad").rstrip("]").partition(" [")
        finite = {name: values for name, values in groups_values.items() if len(values)}
        figures.append(
            (f"distribution: {quantity}", distribution_figure(finite, quantity, unit, scale=scale))
        )
    return figures
