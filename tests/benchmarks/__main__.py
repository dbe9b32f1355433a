"""The benchmark, in one command: `python -m tests.benchmarks`.

Prints ratios measured in one run and writes them to test-output/benchmarks.md and .json. Words
after the command go to pytest: `-k peers` runs the comparison with other programs alone. Those come
with `pip install -e ".[benchmarks,cluster,peers]"`; a missing one is named in the table.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
OUT = FOLDER.parents[1] / "test-output"

if __name__ == "__main__":
    OUT.mkdir(exist_ok=True)
    options = [
        "--override-ini=python_files=bench_*.py",
        "--dist=no",
        "--benchmark-only",
        "--benchmark-columns=median,iqr,rounds",
        f"--benchmark-json={OUT / 'benchmarks.json'}",
        "--quiet",
    ]
    sys.exit(pytest.main([str(FOLDER), *options, *sys.argv[1:]]))
