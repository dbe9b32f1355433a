"""`fotsmc study`: the same run many times, over a grid and random draws."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.output import (
    INTERRUPTED,
    Force,
    file_name,
    plain_console,
    plain_table,
    result_folder,
    say,
    say_error,
)
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.console import Console

    from fotsmc_pin.evaluation.studies import ClosedLoop, StudyResult
    from fotsmc_pin.evaluation.studies.result import Row

STORE = "study.sqlite"


def study_command(
    file: Annotated[Path, typer.Argument(help="A TOML file; see examples/panda_study.toml.")],
    out: Annotated[Path | None, typer.Option(help="Folder for the results.")] = None,
    jobs: Annotated[int, typer.Option(help="Processes; -1 for one per core.")] = -1,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler, such as tcp://host:8786.")
    ] = None,
    metric: Annotated[str, typer.Option(help="The metric to judge by.")] = "tail_rms_error",
    learn: Annotated[
        bool, typer.Option("--learn", help="Let the law learn its model while the arm moves.")
    ] = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Run those again that failed.")
    ] = False,
    force: Force = False,
) -> None:
    """Run a study; one that was interrupted goes on where it was.

    The folder gets the store of all runs, the distribution of one metric, and the worst run with
    its page.
    """
    from fotsmc_pin import checks
    from fotsmc_pin.analysis.metrics import UNITS
    from fotsmc_pin.evaluation.studies import check_study, read_study, study

    checks.choice("--metric", metric, [*UNITS])
    run, arguments = read_study(file)
    if learn:
        run = _learning(run, arguments)
    check_study(run, **arguments)
    folder = out or Path("out") / file_name(file.stem)
    store = folder / STORE
    if force or not store.is_file():
        result_folder(folder, force=force)
        for old in folder.glob(f"{STORE}*"):
            old.unlink()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        found = study(
            run,
            **arguments,
            jobs=jobs,
            store=store,
            scheduler=scheduler,
            retry_failed=retry_failed,
            progress=True,
        )
    except KeyboardInterrupt:
        say_error(
            f"interrupted; every finished run is kept in {store}, and the same command goes on "
            "from there"
        )
        raise typer.Exit(INTERRUPTED) from None
    console = plain_console()
    for row in found.failed[:5]:
        say(f"failed: {dict(row.parameters)}: {row.error}")
    if found.succeeded:
        _show(console, found, list(arguments["grid"]), metric, folder)
        _keep_worst(run, found.worst(metric), folder)
        say(f"All {len(found)} runs are in {store}, {len(found.failed)} failed.")
        say(f"Open {folder / 'worst.html'} in a browser: the worst run.")
    else:
        say(f"All {len(found)} runs failed.")
        raise typer.Exit(1)


def _learning(run: ClosedLoop, arguments: Mapping[str, Any]) -> ClosedLoop:
    for table in ("grid", "draws"):
        if "learn" in arguments[table]:
            remedy = f"leave it out: [{table}] of the file says which runs learn"
            raise ArgumentError("--learn", True, remedy)
    return replace(run, learn=True)


def _show(
    console: Console, found: StudyResult, names: list[str], metric: str, folder: Path
) -> None:
    from fotsmc_pin.analysis.metrics import UNITS
    from fotsmc_pin.evaluation.studies import StudyResult
    from fotsmc_pin.view import distribution_figure, save_figure

    rows: dict[str, list[Row]] = {}
    for row in found.succeeded:
        name = ", ".join(str(row.parameters[name]) for name in names) or "all runs"
        rows.setdefault(name, []).append(row)
    groups = {name: StudyResult(tuple(members)) for name, members in rows.items()}
    unit = UNITS[metric]
    table = plain_table(f"{metric} [{unit}]")
    table.add_column("group")
    for column in ("runs", "5 %", "median", "95 %", "worst"):
        table.add_column(column, justify="right")
    for name, group in groups.items():
        quantiles = (f"{value:.4g}" for value in group.quantiles(metric))
        table.add_row(name, str(len(group)), *quantiles)
    console.print(table)
    values = {name: group.metric(metric) for name, group in groups.items()}
    shown = distribution_figure(values, metric.replace("_", " "), unit)
    save_figure(shown, folder / "distribution")


def _keep_worst(run: ClosedLoop, row: Row, folder: Path) -> None:
    from fotsmc_pin.view import export_html, plot

    rec = run.record(row.parameters, row.seed)
    rec.save(folder / "worst.npz", progress=True)
    plot(rec, folder / "worst")
    export_html(rec, folder / "worst.html", progress=True)
