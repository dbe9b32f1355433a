"""A study gives the same rows however it is run, loses none, and survives its runs."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, StudyError
from fotsmc_pin.evaluation.studies.result import Row, StudyResult
from tests.evaluation.studies import runs

GRID = {"x": [0.1, 0.2, 0.7]}
DRAWS = {"y": fp.Uniform(0.0, 1.0)}


def test_rows_come_in_the_order_of_the_cases():
    found = fp.study(runs.noisy_square, grid=GRID, repeats=2, jobs=1)
    assert [row.parameters["x"] for row in found.rows] == [0.1, 0.1, 0.2, 0.2, 0.7, 0.7]
    assert found.metric("square").tolist() == [x * x / 3 for x in (0.1, 0.1, 0.2, 0.2, 0.7, 0.7)]
    assert len(found.where({"x": 0.2})) == 2


def test_two_processes_and_dask_give_the_same_bits(tmp_path):
    from distributed import LocalCluster

    loop = fp.ClosedLoop(arm=fp.load_arm("two_link"), controller="ComputedTorque", duration=0.05)
    arguments = {"draws": {"mass_scale": fp.Uniform(0.8, 1.2)}, "repeats": 4, "seed": 5}
    alone = fp.study(loop, jobs=1, **arguments)
    assert not alone.failed
    together = fp.study(loop, jobs=2, store=tmp_path / "study.sqlite", **arguments)
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        distributed = fp.study(loop, scheduler=cluster.scheduler.address, **arguments)
    for other in (together, distributed):
        assert [row.metrics for row in other.rows] == [row.metrics for row in alone.rows]
        assert [row.parameters for row in other.rows] == [row.parameters for row in alone.rows]


def test_the_run_goes_to_each_process_once(tmp_path):
    log = tmp_path / "arrivals"
    found = fp.study(runs.CountsItsArrivals(str(log)), grid={"x": list(range(30))}, jobs=2)
    workers = set(found.metric("process"))
    arrivals = Counter(log.read_text().split())
    assert os.getpid() not in workers
    assert {int(process) for process in arrivals} == workers
    assert max(arrivals.values()) == 1


def test_a_failed_run_is_a_row_and_not_the_end(tmp_path):
    store = tmp_path / "study.sqlite"
    found = fp.study(runs.fragile, grid={"x": [0.5, 2.0, 1.0]}, jobs=1, store=store)
    assert [row.error for row in found.rows] == [
        None,
        "ArithmeticError: x = 2.0 is too much",
        None,
    ]
    assert found.metric("x").tolist() == [0.5, 1.0]
    again = fp.study(runs.fragile, grid={"x": [0.5, 2.0, 1.0]}, jobs=1, store=store)
    assert again == found


def test_failed_runs_are_run_again_on_demand(tmp_path):
    log, store = tmp_path / "log", tmp_path / "study.sqlite"
    arguments = {"grid": {"log": [str(log)], "x": [1, 2]}, "jobs": 1, "store": store}
    fp.study(runs.logged, **arguments)
    with sqlite3.connect(store) as database:
        database.execute("UPDATE runs SET error = 'lost' WHERE parameters LIKE '%\"x\": 2%'")
    database.close()
    assert len(fp.study(runs.logged, **arguments).failed) == 1
    assert not fp.study(runs.logged, **arguments, retry_failed=True).failed
    assert log.read_text().split() == ["1", "2", "2"]


def test_a_study_continues_from_a_store_of_an_older_version(tmp_path):
    log, store = tmp_path / "log", tmp_path / "study.sqlite"
    grid = {"log": [str(log)], "x": [1, 2]}
    fp.study(runs.logged, grid=grid, jobs=1, store=store)
    with sqlite3.connect(store) as database:
        database.executescript("ALTER TABLE metrics RENAME TO figures; PRAGMA user_version = 1;")
    database.close()
    wider = fp.study(runs.logged, grid=grid | {"x": [1, 2, 3]}, jobs=1, store=store)
    assert wider.metric("x").tolist() == [1.0, 2.0, 3.0]
    assert log.read_text().split() == ["1", "2", "3"]


def test_a_store_of_a_newer_version_is_refused_by_number(tmp_path):
    store = tmp_path / "study.sqlite"
    with sqlite3.connect(store) as database:
        database.execute("PRAGMA user_version = 99")
    database.close()
    with pytest.raises(StudyError, match="store format 99, this version reads 1 and 2"):
        fp.study(runs.noisy_square, grid=GRID, jobs=1, store=store)


def test_a_store_holds_several_studies_and_grows(tmp_path):
    log, store = tmp_path / "log", tmp_path / "study.sqlite"
    grid = {"log": [str(log)], "x": [1, 2]}
    fp.study(runs.logged, grid=grid, jobs=1, store=store)
    fp.study(runs.noisy_square, grid=GRID, jobs=1, store=store)
    wider = fp.study(runs.logged, grid=grid | {"x": [2, 3, 1]}, jobs=1, store=store)
    assert wider.metric("x").tolist() == [2.0, 3.0, 1.0]
    assert log.read_text().split() == ["1", "2", "3"]


def test_a_killed_study_keeps_its_runs_and_goes_on(tmp_path):
    log, store = tmp_path / "log", tmp_path / "study.sqlite"
    program = (
        "import fotsmc_pin as fp\nfrom tests.evaluation.studies import runs\n"
        f"fp.study(runs.logged, grid={{'log': [{str(log)!r}], 'x': list(range(60))}},\n"
        f"         jobs=1, store={str(store)!r})\n"
    )
    with subprocess.Popen([sys.executable, "-c", program], env=environment()) as process:
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline and (not log.is_file() or lines(log) < 5):
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    started = lines(log)
    assert 5 <= started < 60
    with sqlite3.connect(store) as database:
        (kept,) = database.execute("SELECT count(*) FROM runs").fetchone()
    database.close()
    assert started - 1 <= kept <= started  # all but the one that was under way
    found = fp.study(
        runs.logged, grid={"log": [str(log)], "x": list(range(60))}, jobs=2, store=store
    )
    assert found.metric("x").tolist() == list(range(60))
    assert lines(log) == 60 + started - kept


def test_progress_runs_from_what_is_there_to_the_end(tmp_path):
    store = tmp_path / "study.sqlite"
    fp.study(runs.noisy_square, grid={"x": [1.0, 2.0]}, jobs=1, store=store)
    told = []
    grid = {"x": [1.0, 2.0, 3.0, 4.0]}
    fp.study(runs.noisy_square, grid=grid, jobs=1, store=store, progress=told.append)
    assert told == [0.5, 0.75, 1.0]


@pytest.mark.parametrize("jobs", [0, 1.5, True])
def test_a_number_of_jobs_that_makes_no_sense_is_refused(jobs):
    with pytest.raises(ArgumentError, match="jobs"):
        fp.study(runs.noisy_square, grid=GRID, jobs=jobs)


def test_a_file_that_is_no_store_is_refused_and_left_alone(tmp_path):
    other = tmp_path / "notes.txt"
    other.write_text("not a database, but a text of some length " * 100)
    before = other.read_bytes()
    with pytest.raises(StudyError, match=r"notes\.txt"):
        fp.study(runs.noisy_square, grid=GRID, jobs=1, store=other)
    assert other.read_bytes() == before


def test_the_worst_run_and_the_quantiles_are_runs():
    values = [3.0, 1.0, np.inf, 2.0]
    rows = [Row(parameters={}, seed=k, metrics={"e": v}) for k, v in enumerate(values)]
    found = StudyResult((*rows, Row(parameters={}, seed=9, error="lost")))
    assert found.worst("e").seed == 2
    assert found.worst("e", key=lambda e: -e).seed == 1
    assert found.quantiles("e", (0.0, 0.5, 1.0)).tolist() == [1.0, 3.0, np.inf]
    with pytest.raises(ArgumentError, match="name"):
        found.metric("f")
    lost = Row(parameters={}, seed=0, metrics={"e": np.nan})
    assert StudyResult((*found.rows, lost)).worst("e") in (found.rows[2], lost)


def test_infinite_metrics_and_missing_ones_come_back_from_the_store(tmp_path):
    store = tmp_path / "study.sqlite"
    found = fp.study(unusual, jobs=1, store=store)
    (row,) = fp.study(unusual, jobs=1, store=store).rows
    assert row.metrics["settling"] == np.inf
    assert np.isnan(row.metrics["undefined"])
    assert found.rows[0].seconds == row.seconds


def unusual(parameters, seed):
    return {"settling": np.inf, "undefined": np.nan}


def lines(path: Path) -> int:
    return len(path.read_text().splitlines())


def environment() -> dict[str, str]:
    root = str(Path(fp.__file__).parents[1])
    return os.environ | {"PYTHONPATH": root}
