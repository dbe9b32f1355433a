"""Compiled code on disk never outlives the name or the source that it was made from."""

import subprocess
import sys

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
