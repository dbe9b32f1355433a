"""The tests under several versions of Python and of what is depended on."""

from __future__ import annotations

import os

from tests.release.environments import (
    PYTHONS,
    ROOT,
    CheckError,
    environment,
    interpreter,
    run,
    say,
)

QUICK = ("fractional", "arms", "references", "control", "simulation")
"""Folders of tests that stand for all in a cell of the matrix."""
LOWEST_ON = PYTHONS[0]
"""Newer Pythons have no wheels of the lowest versions."""


def matrix(folder, tests, pythons=PYTHONS, ends=("lowest", "newest")):
    """Run the tests in a clean environment for each cell and print the table.

    Args:
        folder: where environments are made.
        tests: words for pytest; none runs the folders `QUICK`.
        pythons: versions to try.
        ends: which versions of the dependencies.

    Raises:
        CheckError: a cell did not pass; all cells are tried first.
    """
    tools = environment(folder / "tools")
    run([tools / "pip", "install", "-q", "uv"], folder, "uv")
    rows, lost = [], False
    for version in pythons:
        for end in ends:
            if end == "lowest" and version != LOWEST_ON:
                continue
            python = interpreter(version)
            if python is None:
                rows.append((version, end, "not tried: this Python is not on the machine"))
                continue
            try:
                told = _cell(tools / "uv", folder / f"{version}-{end}", python, end, tests)
                rows.append((version, end, told))
            except CheckError as failure:
                lost = True
                say(str(failure))
                rows.append((version, end, "failed"))
    say("\n| Python | dependencies | tests |\n| --- | --- | --- |")
    for row in rows:
        say(f"| {' | '.join(row)} |")
    if lost:
        raise CheckError("a cell of the matrix did not pass")


def _cell(uv, folder, python, end, tests):
    programs = environment(folder, python)
    words = [uv, "pip", "install", "-q", "--python", programs / "python"]
    words += ["--resolution", "lowest-direct" if end == "lowest" else "highest"]
    run([*words, "-e", f"{ROOT}[test]"], ROOT, f"{end} versions installed")
    chosen = tests or [f"tests/{name}" for name in QUICK]
    jobs = str(min(os.cpu_count() or 1, 4))
    words = [programs / "python", "-m", "pytest", "-q", "-n", jobs, *chosen]
    # What other versions of Numba have compiled stays where it is.
    text = run(words, ROOT, "tests", NUMBA_CACHE_DIR=folder / "compiled")
    return text.strip().splitlines()[-1].strip("= ")
