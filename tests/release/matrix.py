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

SMOKE = (
    *("arms/test_arm.py", "arms/test_markup.py", "arms/test_mujoco.py"),
    *("control/test_saturation.py", "fractional/test_accuracy.py", "learning/test_regressor.py"),
    *("references/test_live_target.py", "references/test_cartesian_line.py"),
    *("references/test_excitation.py", "simulation/test_loop.py", "simulation/test_friction.py"),
    "evaluation/tuning/test_front.py",
    "evaluation/studies/test_study.py::test_two_processes_and_dask_give_the_same_bits",
    *("identification/test_payload.py", "identification/test_ros_log.py"),
    *("robust/test_adapters.py", "cli/test_task.py"),
    *("view/test_data_files.py", "view/test_plot.py"),
    "view/test_many_runs_report.py",
)
"""Tests that stand for all in a cell of the matrix: together they use all that is depended on."""
RESOLUTIONS = {"lowest": "lowest-direct", "newest": "highest"}
"""What uv calls either end. Only wheels count: what a Python has none of is not its lowest."""


def matrix(folder, tests, pythons=PYTHONS, ends=("lowest", "newest")):
    """Run the tests in a clean environment for each cell and print the table.

    Args:
        folder: where environments are made.
        tests: words for pytest; none runs `SMOKE`.
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
            cell = f"Python {version}, {end}"
            try:
                versions = folder / f"{version}-{end}.txt"
                words = [tools / "uv", "pip", "compile", "-q", "--python-version", version]
                words += ["--only-binary", ":all:", "--resolution", RESOLUTIONS[end]]
                words += ["--extra", "test", "pyproject.toml", "-o", versions]
                run(words, ROOT, f"{cell}: a wheel of everything")
                python = interpreter(version)
                if python is None:
                    told = "not tried: there are wheels, but this Python is not on the machine"
                else:
                    told = _cell(tools / "uv", folder / f"{version}-{end}", python, versions, tests)
            except CheckError as failure:
                lost = True
                say(str(failure))
                told = "failed"
            rows.append((version, end, told))
    say("\n| Python | dependencies | tests |\n| --- | --- | --- |")
    for row in rows:
        say(f"| {' | '.join(row)} |")
    if lost:
        raise CheckError("a cell of the matrix did not pass")


def _cell(uv, folder, python, versions, tests):
    programs = environment(folder, python)
    install = [uv, "pip", "install", "-q", "--python", programs / "python"]
    run([*install, "-r", versions], ROOT, "versions installed")
    run([*install, "--no-deps", "-e", ROOT], ROOT, "checkout installed")
    chosen = tests or [f"tests/{name}" for name in SMOKE]
    jobs = str(min(os.cpu_count() or 1, 4))
    # Old versions use what newer ones of their own dependencies give notice of.
    words = [programs / "python", "-m", "pytest", "-q", "-W", "ignore::DeprecationWarning"]
    words += ["-n", jobs, *chosen]
    # What other versions of Numba have compiled stays where it is.
    text = run(words, ROOT, "tests", NUMBA_CACHE_DIR=folder / "compiled")
    return text.strip().splitlines()[-1].strip("= ")
