"""`write_report`: a folder of results as one offline page, from what was run to the moving arm."""

from __future__ import annotations

import html
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from fotsmc_pin.files import write_text
from fotsmc_pin.progress import reporting
from fotsmc_pin.view.about_run import counted
from fotsmc_pin.view.export import export_html
from fotsmc_pin.view.learning_tables import learning_section
from fotsmc_pin.view.many_run_tables import (
    stress_section,
    stress_words,
    study_section,
    study_words,
)
from fotsmc_pin.view.page import ASSETS
from fotsmc_pin.view.prose import prose
from fotsmc_pin.view.report_figures import distributions, figures
from fotsmc_pin.view.report_tables import divergences, facts, metrics_table
from fotsmc_pin.view.results import read_results

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from fotsmc_pin.progress import Progress
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.view.results import Results

RUNS_AT_MOST = 6
"""More arms than this in one picture cannot be told apart."""


def write_report(
    folder: str | os.PathLike[str],
    path: str | os.PathLike[str] | None = None,
    *,
    title: str | None = None,
    progress: Progress = False,
) -> Path:
    """Write one HTML file about a folder of results; it holds everything and fetches nothing.

    The folder is one that a command of `fotsmc` has written (`simulate`, `reproduce`, `study`,
    `stress`, `tune`), or any that holds saved recordings (`*.npz`). A run that diverged is told
    first. Of one or a few runs the report shows the animation, a table of metrics for the revolute
    and for the prismatic joints, the figures (`*.svg` and `*.png`; drawn from the runs where there
    are none), what `ModelLearning` learnt, and what was run: arm and what `perturb` did to it,
    controller, gains, versions. Of many runs it shows how their metrics are spread, and the worst
    run. Tables of the command (`claims.md`, `comparison.md`, `stress.md`, `front.md`,
    `margins.md`) follow.

    Args:
        folder: folder of results.
        path: file to write, whole or not at all; `report.html` in the folder by default.
        title: heading; by default the names of the arms.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        The path that was written.

    Raises:
        RecordingError: the folder holds no result, or damaged files.
        StudyError: a damaged store of a study.
        OSError: the folder cannot be read or the file cannot be written.
    """
    with reporting(progress, "Writing the report") as report:
        results = read_results(folder)
        target = results.folder / "report.html" if path is None else Path(path)
        report(0.2)
        sections = {"Animation": _animation(results)}
        report(0.6)
        sections |= {
            "Distributions": _many_runs(results),
            "Metrics": metrics_table(results.summaries, results.titles),
            "What was learnt": learning_section(results.runs),
            **{name: prose(text) for name, text in results.texts.items()},
            "Figures": figures(results),
            "What was run": facts(results.runs),
        }
        report(0.9)
        write_text(target, _page(results, sections, title))
        report(1.0)
    return target


def _page(results: Results, sections: Mapping[str, str], title: str | None) -> str:
    arms = dict.fromkeys(rec.arm.name for rec in results.runs.values())
    heading = title or " and ".join(arms) or results.folder.resolve().name
    return filled(heading, _subtitle(results), sections, notice=divergences(results.runs))


def filled(heading: str, subtitle: str, sections: Mapping[str, str], *, notice: str = "") -> str:
    """Return the page of a report: sections of HTML by name, of which empty ones are left out."""
    sections = {name: content for name, content in sections.items() if content}
    parts = {
        "style": (ASSETS / "report.css").read_text("utf-8"),
        "title": html.escape(heading),
        "subtitle": html.escape(subtitle),
        "notice": notice,
        "links": "".join(f'<a href="#{_anchor(name)}">{name}</a>' for name in sections),
        "sections": "\n".join(
            f'<section aria-labelledby="{_anchor(name)}">'
            f'<h2 id="{_anchor(name)}">{name}</h2>{content}</section>'
            for name, content in sections.items()
        ),
    }
    template = (ASSETS / "report.html").read_text("utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


def _subtitle(results: Results) -> str:
    runs = results.runs
    laws = dict.fromkeys(str(rec.metadata.get("controller", "")) for rec in runs.values())
    seconds = [f"{max(float(rec.t[-1] - rec.t[0]) for rec in runs.values()):g} s"] if runs else []
    if results.study is not None:
        shown = ["the worst is shown"] if runs else []
        return ", ".join([study_words(results.study), *filter(None, laws), *seconds, *shown])
    if results.stress:
        return stress_words(results.stress)
    if not runs:
        return ", ".join(name.lower() for name in results.texts)
    return ", ".join([*filter(None, laws), counted(len(runs), "run"), *seconds])


def _many_runs(results: Results) -> str:
    """Return how the metrics of many runs are spread, and which was the worst."""
    words = study_section(results.study) if results.study is not None else ""
    if results.stress:
        words += stress_section(results.stress)
    return words + distributions(results) if words else ""


def _animation(results: Results) -> str:
    """Return the runs' page in a frame of its own, which keeps its styles and keys to itself."""
    runs = results.runs
    if not runs:
        return ""
    shown = dict(list(runs.items())[:RUNS_AT_MOST])
    left_out = len(runs) - len(shown)
    note = f"<p>{left_out} more runs are not shown here.</p>" if left_out else ""
    return framed(shown) + note


def framed(runs: Mapping[str, Recording] | Recording) -> str:
    """Return the page of runs as an HTML frame without rights but that to run its own scripts."""
    with tempfile.TemporaryDirectory() as folder:
        page = export_html(runs, Path(folder) / "page.html", play=False).read_text("utf-8")
    escaped = page.replace("&", "&amp;").replace('"', "&quot;")
    name = html.escape(", ".join(runs)) if not hasattr(runs, "arm") else html.escape(runs.arm.name)
    return (
        f'<iframe title="Animation of {name}" sandbox="allow-scripts" loading="lazy" '
        f'srcdoc="{escaped}"></iframe>'
    )
