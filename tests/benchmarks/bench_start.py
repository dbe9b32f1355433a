"""What a new process waits for: imports and the command line's help."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

HEAD = ["start of a new process", "s"]
ROOT = str(Path(__file__).parents[2])
DEPENDENCIES = "import pinocchio, numpy, numba, lazy_loader"
PROGRAMS = {
    "pinocchio, numpy and numba alone": ["-c", DEPENDENCIES],
    "the same and import fotsmc_pin": ["-c", f"{DEPENDENCIES}; import fotsmc_pin"],
    "the same and every public name": [
        "-c",
        f"{DEPENDENCIES}; import fotsmc_pin as fp; [getattr(fp, name) for name in fp.__all__]",
    ],
    "fotsmc --help": ["-m", "fotsmc_pin", "--help"],
    "fotsmc simulate --help": ["-m", "fotsmc_pin", "simulate", "--help"],
}


def test_start(table, benchmark):
    spent = {name: [] for name in PROGRAMS}
    for _ in range(7):
        for name, program in PROGRAMS.items():
            spent[name].append(seconds(program))
    rows = [[name, f"{statistics.median(found):.2f}"] for name, found in spent.items()]
    table("Start", HEAD, *rows)
    benchmark.pedantic(lambda: seconds(PROGRAMS["fotsmc --help"]), rounds=1)


def seconds(program):
    started = time.perf_counter()
    subprocess.run(
        [sys.executable, *program],
        check=True,
        stdout=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": ROOT},
    )
    return time.perf_counter() - started
