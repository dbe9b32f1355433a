"""Compiled code on disk never outlives the name or the source that it was made from."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numba
import pytest
from numba.core.caching import NullCache

import fotsmc_pin
from fotsmc_pin.compiled import CacheWarning, kernel

PACKAGE = Path(fotsmc_pin.__file__).parent

PROGRAM = """
from fotsmc_pin.compiled import kernel


@kernel
def twice(x):
    return 2.0 * x


def main():
    return twice(3.0)


if __name__ == "__main__":
    print(main())
"""

STARTS = {
    "file": ["-c", "import runpy; print(runpy.run_path('own_law.py')['main']())"],
    "module": ["-c", "import own_law; print(own_law.main())"],
    "script": ["own_law.py"],
}


def test_a_file_runs_under_any_name_with_one_cache(tmp_path):
    (tmp_path / "own_law.py").write_text(PROGRAM)
    for name in ("file", "script", "file", "module", "script"):
        done = subprocess.run(
            [sys.executable, *STARTS[name]],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.stdout.strip() == "6.0", f"{name}: {done.stderr}"


CALLEE = """
from fotsmc_pin.compiled import kernel


@kernel
def gain():
    return {gain}
"""
CALLER = """
from fotsmc_pin.compiled import kernel
from fotsmc_pin.callee import gain


@kernel
def scaled(x):
    return gain() * x


if __name__ == "__main__":
    print(scaled(3.0), sum(scaled.stats.cache_hits.values()))
"""


def test_an_edit_of_a_callee_recompiles_its_caller(tmp_path):
    """Numba itself watches the caller's file only; the package's own guard watches all of them."""
    shutil.copytree(PACKAGE, tmp_path / "fotsmc_pin", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "fotsmc_pin/caller.py").write_text(CALLER)

    def run(gain):
        (tmp_path / "fotsmc_pin/callee.py").write_text(CALLEE.format(gain=gain))
        environment = os.environ | {"PYTHONPATH": str(tmp_path)}
        command = [sys.executable, "-m", "fotsmc_pin.caller"]
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert not done.returncode, done.stderr
        return done.stdout.split()

    assert run(gain=2.0) == ["6.0", "0"]
    assert run(gain=2.0) == ["6.0", "1"]
    assert run(gain=5.0) == ["15.0", "0"]


def test_a_numba_with_another_cache_is_noticed(monkeypatch):
    """What cannot be watched is not cached, and the user is told."""

    class Moved:
        """A cache without the stamp of its source."""

    def compiled(function, **options):
        dispatcher = numba_njit(**options)(function)
        if options.get("cache"):
            dispatcher._cache = Moved()
        return dispatcher

    numba_njit = numba.njit
    stand_in = SimpleNamespace(
        njit=lambda **options: lambda function: compiled(function, **options),
        __version__=numba.__version__,
    )
    monkeypatch.setattr("fotsmc_pin.compiled.numba", stand_in)

    def twice(x):
        return 2.0 * x

    with pytest.warns(CacheWarning, match="compiled anew in each process"):
        watched = kernel(twice)
    assert watched(3.0) == 6.0
    assert isinstance(watched._cache, NullCache)
