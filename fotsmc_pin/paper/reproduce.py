"""The main job: the two-link case from two URDFs to figures, metrics, claims and a page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.analysis import reaching_time_bound
from fotsmc_pin.files import write_json, write_text
from fotsmc_pin.paper import comparison, two_link
from fotsmc_pin.paper.claims import judge
from fotsmc_pin.paper.contest import run_contest
from fotsmc_pin.paper.experiments import ALPHAS, EXPERIMENTS, measure, run_all
from fotsmc_pin.paper.figures import draw_figures
from fotsmc_pin.paper.verdicts import Verdict, as_markdown
from fotsmc_pin.progress import reporting
from fotsmc_pin.view import export_html

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from fotsmc_pin.progress import Progress
    from fotsmc_pin.simulation import Recording

RUNS_SHARE, CONTEST_SHARE = 0.3, 0.6


def reproduce(folder: Path, progress: Progress = False) -> list[Verdict]:
    """Run the case and the comparison, and write the results.

    `run.npz`, the figures, `metrics.json`, `claims.md`, `comparison.md` and `two_link.html`.

    Args:
        folder: where the files go; it must exist.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        The verdicts on the paper's claims.
    """
    with reporting(progress, "the two-link case") as report:
        recordings = run_all(lambda fraction: report(RUNS_SHARE * fraction))
        contest = run_contest(lambda fraction: report(RUNS_SHARE + CONTEST_SHARE * fraction))
        metrics = metrics_of(recordings) | {"contest": comparison.contest_metrics(contest)}
        verdicts = judge(metrics)
        recordings["paper"].save(folder / "run.npz")
        write_json(folder / "metrics.json", metrics)
        write_text(folder / "claims.md", as_markdown(verdicts))
        write_text(folder / "comparison.md", comparison.as_markdown(metrics))
        draw_figures(recordings, contest, folder)
        report(0.95)
        export_html(recordings["paper"], folder / "two_link.html")
        report(1.0)
    return verdicts


def metrics_of(recordings: Mapping[str, Recording]) -> dict[str, Any]:
    """Return everything that the verdicts follow from, as plain data."""
    gains = two_link.controller().gains
    runs = {name: measure(rec) for name, rec in recordings.items()}
    return {
        "case": {
            "dt": two_link.DT,
            "duration": two_link.DURATION,
            "substeps": two_link.SUBSTEPS,
            "versions": recordings["paper"].metadata["versions"],
        },
        "gains": gains.as_dict(),
        "alphas": list(ALPHAS),
        "experiments": {name: experiment.title for name, experiment in EXPERIMENTS.items()},
        "reaching_time_bound": reaching_time_bound(
            recordings["paper"].signals["s"][0], theta=float(gains.theta[0]), mu=gains.mu
        ),
        "runs": runs,
    }
