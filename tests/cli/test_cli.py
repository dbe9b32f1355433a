"""The command line: what it writes, what it refuses, and how it says so."""

import contextlib
import json
import resource
import sqlite3

import pytest

from fotsmc_pin.simulation import Recording


def test_help_comes_at_once(new_fotsmc):
    new_fotsmc("--help")

    def seconds():
        """Processor time, as others may use the machine."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        result = new_fotsmc("--help")
        assert result.returncode == 0
        for command in ("reproduce", "simulate", "animate", "arms", "inspect", "perturb"):
            assert command in result.stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    assert min(seconds() for _ in range(3)) < 1.0


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
def test_a_mistake_ends_in_one_clear_line_and_exit_code_2(fotsmc, tmp_path, arguments, words):
    result = fotsmc(*arguments)
    assert result.returncode == 2
    assert words in result.stderr
    assert "Traceback" not in result.stderr
    assert not any(tmp_path.rglob("*.npz"))


def test_simulate_writes_a_whole_result_and_never_over_another(fotsmc, tmp_path):
    arguments = ("simulate", "two_link", "--duration", "0.5", "--out", "run")
    result = fotsmc(*arguments)
    assert result.returncode == 0, result.stderr
    metrics = json.loads((tmp_path / "run/metrics.json").read_text())
    assert metrics["duration"] == pytest.approx(0.5)
    for name in ("run.npz", "run.png", "two_link.html"):
        assert (tmp_path / "run" / name).stat().st_size > 1000

    again = fotsmc(*arguments)
    assert again.returncode == 2
    assert "--force" in again.stderr
    assert fotsmc(*arguments, "--force").returncode == 0

    page = fotsmc("animate", "run/run.npz", "-o", "page.html")
    assert page.returncode == 0, page.stderr
    assert (tmp_path / "page.html").stat().st_size > 1000


def test_a_file_that_is_no_recording_is_refused(fotsmc, tmp_path):
    (tmp_path / "run.npz").write_bytes(b"not a zip file")
    result = fotsmc("animate", "run.npz")
    assert result.returncode == 2
    assert "not a recording" in result.stderr


def test_the_panda_with_heavier_links_is_tracked_within_5_mrad(fotsmc, tmp_path):
    result = fotsmc("simulate", "panda", "--mass-scale", "1.1", "--out", "panda")
    assert result.returncode == 0, result.stderr
    metrics = json.loads((tmp_path / "panda/metrics.json").read_text())
    assert metrics["tail_rms_error"] < 5e-3
    assert metrics["saturation_fraction"] == 0.0


def test_a_run_that_diverges_says_when_and_where_and_keeps_what_was_recorded(fotsmc, tmp_path):
    wild = ("--controller", "LinearSMC", "--gain", "Lambda=1e7", "--gain", "K=1e7", "--dt", "0.5")
    result = fotsmc("simulate", "two_link", *wild, "--duration", "20", "--out", "x")
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


def test_a_study_leaves_its_runs_their_distribution_and_the_worst_and_goes_on(fotsmc, tmp_path):
    file, store = tmp_path / "heavy.toml", tmp_path / "out/heavy/study.sqlite"

    def runs():
        with contextlib.closing(sqlite3.connect(store)) as database:
            return set(database.execute("SELECT seed, parameters, seconds FROM runs"))

    file.write_text(STUDY.format(repeats=2))
    refused = fotsmc("study", file.name, "--metric", "tail_error")
    assert refused.returncode == 2
    assert "tail_rms_error" in refused.stderr
    assert not store.exists()

    first = fotsmc("study", file.name)
    assert first.returncode == 0, first.stderr
    assert "tail_rms_error [rad]" in first.stdout
    assert "All 4 runs" in first.stdout
    for name in ("distribution.png", "distribution.svg", "worst.npz", "worst.png", "worst.html"):
        assert (store.parent / name).stat().st_size > 1000
    assert "[rad]" in (store.parent / "distribution.svg").read_text()
    before = runs()
    assert len(before) == 4

    file.write_text(STUDY.format(repeats=3))
    second = fotsmc("study", file.name)
    assert "All 6 runs" in second.stdout
    assert len(runs()) == 6
    assert before < runs(), "a run that was there was run again"
