"""A new process waits for nothing that it does not use."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("start", ["import fotsmc_pin", "import fotsmc_pin.cli"])
def test_the_library_and_the_command_line_import_nothing_heavy(start):
    program = (
        f"import sys; {start}\n"
        "heavy = ('numpy', 'numba', 'pinocchio', 'matplotlib', 'meshcat', 'joblib')\n"
        "print(*(name for name in heavy if name in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == []
