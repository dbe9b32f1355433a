"""The command line: what it writes, what it refuses, and how it says so."""

import contextlib
import json
import sqlite3
import subprocess
import sys
import time

import pytest

from fotsmc_pin.simulation import Recording


def fotsmc(*arguments, cwd):
    """Run the command line as its users do, in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "fotsmc_pin", *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )


def test_help_comes_at_once(tmp_path):
    fotsmc("--help", cwd=tmp_path)
    started = time.perf_counter()
    result = fotsmc("--help", cwd=tmp_path)
    assert result.returncode == 0
    assert time.perf_counter() - started < 1.0
    for command in ("reproduce", "simulate", "animate", "arms", "inspect", "perturb"):
        assert command in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("simulate", "no_such_arm"), "no_such_arm"),
        (("simulate", "two_link", "--controller", "Nonsense"), "--controller"),
        (("simulate", "two_link", "--gain", "thetta=3"), "did you mean theta"),
        (("simulate", "two_link", "--gain", "theta=-3"), "theta"),
        (("simulate", "two_link", "--gain", "theta"), "name=value"),
        (("simulate", "two_link", "--dt", "0"), "dt"),
        (("simulate", "two_link", "--duration", "nan"), "duration"),
        (("simulate", "two_link", "--mass-scale", "-1"), "--mass-scale"),
        (("animate", "nothing.npz"), "nothing.npz"),
        (("frobnicate",), "frobnicate"),
    ],
)
def test_a_mistake_ends_in_one_clear_line_and_exit_code_2(tmp_path, arguments, words):
    result = fotsmc(*arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert words in result.stderr
    assert "Traceback" not in result.stderr
    assert not any(tmp_path.rglob("*.npz"))


def test_simulate_writes_a_whole_result_and_never_over_another(tmp_path):
    arguments = ("simulate", "two_link", "--duration", "0.5", "--out", "run")
    result = fotsmc(*arguments, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    metrics = json.loads((tmp_path / "run/metrics.json").read_text())
    assert metrics["duration"] == pytest.approx(0.5)
    for name in ("run.npz", "run.png", "two_link.html"):
        assert (tmp_path / "run" / name).stat().st_size > 1000

    again = fotsmc(*arguments, cwd=tmp_path)
    assert again.returncode == 2
    assert "--force" in again.stderr
    assert fotsmc(*arguments, "--force", cwd=tmp_path).returncode == 0

    page = fotsmc("animate", "run/run.npz", "-o", "page.html", cwd=tmp_path)
    assert page.returncode == 0, page.stderr
    assert (tmp_path / "page.html").stat().st_size > 1000


def test_a_file_that_is_no_recording_is_refused(tmp_path):
    (tmp_path / "run.npz").write_bytes(b"not a zip file")
    result = fotsmc("animate", "run.npz", cwd=tmp_path)
    assert result.returncode == 2
    assert "not a recording" in result.stderr


def test_the_panda_with_heavier_links_is_tracked_within_5_mrad(tmp_path):
    result = fotsmc("simulate", "panda", "--mass-scale", "1.1", "--out", "panda", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    metrics = json.loads((tmp_path / "panda/metrics.json").read_text())
    assert metrics["tail_rms_error"] < 5e-3
    assert metrics["saturation_fraction"] == 0.0


def test_a_run_that_diverges_says_when_and_where_and_keeps_what_was_recorded(tmp_path):
    wild = ("--controller", "LinearSMC", "--gain", "Lambda=1e7", "--gain", "K=1e7", "--dt", "0.5")
    result = fotsmc("simulate", "two_link", *wild, "--duration", "20", "--out", "x", cwd=tmp_path)
    assert result.returncode == 2
    assert "diverged at t = " in result.stderr
    assert "joint1" in result.stderr
    assert 0 < len(Recording.load(tmp_path / "x/run.npz")) < 41


STUDY = """
[study]
repeats = {repeats}
[run]
arm = "two_link"
duration = 0.2
[grid]
controller = ["RobustFONFTSM", "ComputedTorque"]
[draws]
mass_scale = {{ low = 0.9, high = 1.1 }}
"""


def test_a_study_leaves_its_runs_their_distribution_and_the_worst_and_goes_on(tmp_path):
    file, store = tmp_path / "heavy.toml", tmp_path / "out/heavy/study.sqlite"

    def runs():
        with contextlib.closing(sqlite3.connect(store)) as database:
            return set(database.execute("SELECT seed, parameters, seconds FROM runs"))

    file.write_text(STUDY.format(repeats=2))
    refused = fotsmc("study", file.name, "--metric", "tail_error", cwd=tmp_path)
    assert refused.returncode == 2
    assert "tail_rms_error" in refused.stderr
    assert not store.exists()

    first = fotsmc("study", file.name, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    assert "tail_rms_error [rad]" in first.stdout
    assert "All 4 runs" in first.stdout
    for name in ("distribution.png", "distribution.svg", "worst.npz", "worst.png", "worst.html"):
        assert (store.parent / name).stat().st_size > 1000
    assert "[rad]" in (store.parent / "distribution.svg").read_text()
    before = runs()
    assert len(before) == 4

    file.write_text(STUDY.format(repeats=3))
    second = fotsmc("study", file.name, cwd=tmp_path)
    assert "All 6 runs" in second.stdout
    assert len(runs()) == 6
    assert before < runs(), "a run that was there was run again"
