"""`study`: the same run over a grid and random draws, on all cores, resumable."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.studies.planned_runs import planned_runs, probes
from fotsmc_pin.evaluation.studies.result import StudyResult
from fotsmc_pin.evaluation.studies.store import Store
from fotsmc_pin.evaluation.studies.workers import run_all
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from fotsmc_pin.evaluation.studies.planned_runs import Distributions, Grid, PlannedRun
    from fotsmc_pin.progress import Progress


def study(
    run: Callable[..., Any],
    *,
    grid: Grid | None = None,
    draws: Distributions | None = None,
    repeats: int = 1,
    seed: int = 0,
    jobs: int = -1,
    store: str | os.PathLike[str] | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
    progress: Progress = False,
) -> StudyResult:
    """Run every point of a grid, each with random draws, and collect their metrics.

    All points of the grid meet the same draws. The results do not depend on the number of
    processes, on Dask, or on interruptions: they are the same bit for bit.

    Args:
        run: `(parameters, seed) -> metrics`; `parameters` is a dict of what is different in this
            run, `metrics` a `Summary` or a dict of numbers. `ClosedLoop` is one; any function or
            object that pickles will do. An error that it raises becomes a row. Where it has a
            method `check(parameters)`, that is asked of every point of the grid, with the draws at
            their ends, before the first run, and its error ends the study.
        grid: names and lists of values; every combination is run. The values are plain data.
        draws: names, each with a `Uniform` or a list to draw from.
        repeats: draws for each point of the grid.
        seed: where all random numbers come from.
        jobs: processes on this machine; -1 for one per core, 1 for none but this one.
        store: SQLite file into which each run is written once it is done. Runs that are there
            already are not run again; more repeats, or a wider grid, go on from them. None keeps
            nothing.
        scheduler: address of a Dask scheduler, in place of processes on this machine.
        retry_failed: run those again that the store holds as failed.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        All rows, in the order of the grid and the draws.

    Raises:
        ArgumentError: an argument is unusable.
        StudyError: the file is no store of studies.
        MissingDependencyError: a scheduler is given and Dask is not installed.
    """
    if jobs == 0 or isinstance(jobs, bool) or not isinstance(jobs, int):
        raise ArgumentError("jobs", jobs, "give a number of processes, or -1 for one per core")
    wanted = check_study(run, grid=grid, draws=draws, repeats=repeats, seed=seed)
    name = identity(run)
    with Store(store) as kept, reporting(progress, "study") as report:
        done = kept.finished(failed=not retry_failed)
        missing = [planned for planned in wanted if planned.key(name) not in done]
        finished = len(wanted) - len(missing)
        report(finished / len(wanted))
        for planned, row in run_all(run, missing, jobs=jobs, scheduler=scheduler):
            kept.write(name, planned, row)
            finished += 1
            report(finished / len(wanted))
        return StudyResult(tuple(kept.read(planned.key(name) for planned in wanted)))


def check_study(
    run: Callable[..., Any],
    *,
    grid: Grid | None = None,
    draws: Distributions | None = None,
    repeats: int = 1,
    seed: int = 0,
) -> list[PlannedRun]:
    """Return the runs of a study, once all that can be checked beforehand is checked.

    Raises:
        ArgumentError: an argument, or a parameter that `run.check` refuses.
    """
    if not callable(run):
        remedy = "give a ClosedLoop, or a function (parameters, seed) -> metrics"
        raise ArgumentError("run", run, remedy)
    wanted = planned_runs(grid or {}, draws or {}, repeats, seed)
    check = getattr(run, "check", None)
    if check is not None:
        for parameters in probes(grid or {}, draws or {}):
            check(parameters)
    return wanted


def identity(run: Callable[..., Any]) -> str:
    """Return the name under which a store keeps the runs of `run`.

    An object says it itself by its attribute `identity`; a function's is its module and name. What
    the function does is not part of it: after changing a function, start a new store.
    """
    own = getattr(run, "identity", None)
    if own is not None:
        return hashlib.sha256(str(own).encode()).hexdigest()[:16]
    name = getattr(run, "__qualname__", None) or type(run).__qualname__
    return f"{run.__module__}.{name}"
