"""Runs per second of a study: one process, two, and a Dask cluster of two on this machine."""

from __future__ import annotations

import statistics
import time

import fotsmc_pin as fp

HEAD = ["workers", "runs per second", "× one process"]
RUNS = 16
ROUNDS = 7


def test_studies(table, benchmark):
    from distributed import LocalCluster

    loop = fp.ClosedLoop(
        arm=fp.load_arm("panda"), controller="AdaptiveFONFTSM", preset="practical", duration=5.0
    )

    def per_second(repeats=RUNS, **workers):
        started = time.perf_counter()
        found = fp.study(
            loop, draws={"mass_scale": fp.Uniform(0.9, 1.1)}, repeats=repeats, **workers
        )
        assert not found.failed
        return repeats / (time.perf_counter() - started)

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        kinds = {
            "1 process": {"jobs": 1},
            "2 processes": {"jobs": 2},
            "Dask, 2 workers": {"scheduler": cluster.scheduler_address},
        }
        for workers in kinds.values():
            per_second(4, **workers)  # the machine code is loaded, the workers stand by
        speeds = {name: [] for name in kinds}
        for _ in range(ROUNDS):
            for name, workers in kinds.items():
                speeds[name].append(per_second(**workers))
    alone = speeds["1 process"]
    rows = [
        [
            name,
            f"{statistics.median(found):.2f}",
            f"{statistics.median(a / b for a, b in zip(found, alone, strict=True)):.2f}",
        ]
        for name, found in speeds.items()
    ]
    table("A study of Panda runs, 5 s at 1 kHz each", HEAD, *rows)
    benchmark.pedantic(lambda: loop({}, 0), rounds=1)
