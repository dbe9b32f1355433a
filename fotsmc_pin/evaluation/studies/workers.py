"""Runs on other cores and machines: joblib's processes, or Dask where a scheduler is given."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
import time
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cloudpickle
import joblib

from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.evaluation.studies.result import Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from fotsmc_pin.evaluation.studies.planned_runs import PlannedRun

    Run = Callable[..., Any]

LOOK_FOR_PARENT = 1.0
"""How often a worker looks whether the process that started it still lives [s]."""


def carry_out(run: Run, planned: PlannedRun) -> Row:
    """Carry out a planned run; an error becomes part of the row."""
    started = time.perf_counter()
    metrics: dict[str, float] = {}
    error = None
    try:
        outcome = run(dict(planned.parameters), planned.seed)
        outcome = outcome.as_dict() if hasattr(outcome, "as_dict") else dict(outcome)
        metrics = {name: float(value) for name, value in outcome.items()}
    except Exception as raised:  # A study outlives every run: whatever it was, it is noted.
        error = f"{type(raised).__name__}: {raised}"
    took = time.perf_counter() - started
    return Row(
        parameters=planned.parameters, seed=planned.seed, metrics=metrics, error=error, seconds=took
    )


def run_all(
    run: Run, wanted: Sequence[PlannedRun], *, jobs: int, scheduler: str | None
) -> Iterator[tuple[PlannedRun, Row]]:
    """Yield each planned run with its row as soon as it is done, in any order.

    `run`, and with it every model, goes to a worker once, not with each planned run.
    """
    if scheduler is None and (jobs == 1 or len(wanted) < 2):
        yield from ((planned, carry_out(run, planned)) for planned in wanted)
        return
    workers = _processes(run, jobs) if scheduler is None else _cluster(run, scheduler)
    with workers as (there, options):
        tasks = (
            joblib.delayed(_run_numbered)(there, k, planned) for k, planned in enumerate(wanted)
        )
        parallel = joblib.Parallel(**options, batch_size=1, return_as="generator_unordered")
        for k, row in parallel(tasks):
            yield wanted[k], row


def _run_numbered(there: Any, number: int, planned: PlannedRun) -> tuple[int, Row]:
    run = there.get() if isinstance(there, OnDisk) else there
    return number, carry_out(run, planned)


@contextmanager
def _processes(run: Run, jobs: int) -> Iterator[tuple[OnDisk, dict[str, Any]]]:
    with tempfile.TemporaryDirectory(prefix="fotsmc-study-") as folder:
        path = Path(folder) / "run.pickle"
        path.write_bytes(cloudpickle.dumps(run))
        yield OnDisk(path), {"n_jobs": jobs, "backend": "loky", "initializer": live_with_parent}


def live_with_parent() -> None:
    """Let this worker end with the process that started it, however that one ends.

    Ctrl-C is left to the parent, which stops its workers; where the parent is gone without a word
    (`kill -9`), the worker ends within seconds by itself.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(LOOK_FOR_PARENT)
        os._exit(1)

    threading.Thread(target=watch, name="live_with_parent", daemon=True).start()


class OnDisk:
    """Something on this machine's disk that every process reads once."""

    def __init__(self, path: Path) -> None:
        """Stand for what is pickled at `path`."""
        self.path = path

    def get(self) -> Any:
        """Return it, the same object at every call in one process."""
        return _read(self.path)


@lru_cache(maxsize=1)
def _read(path: Path) -> Any:
    return cloudpickle.loads(path.read_bytes())


@contextmanager
def _cluster(run: Run, scheduler: str) -> Iterator[tuple[Run, dict[str, Any]]]:
    try:
        from distributed import Client
    except ImportError as error:
        raise MissingDependencyError(
            "a scheduler needs Dask: pip install 'dask[distributed]'"
        ) from error
    try:
        client = Client(scheduler, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        remedy = f"give the address of a Dask scheduler, such as tcp://host:8786 ({error})"
        raise ArgumentError("scheduler", scheduler, remedy) from error
    with client, joblib.parallel_config(backend="dask", client=client, scatter=[run]):
        yield run, {}
