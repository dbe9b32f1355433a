"""However a command ends, it says so in one line, keeps what is there and leaves nothing behind."""

import os
import resource
import signal
import sqlite3
import time
from pathlib import Path

import pytest

from fotsmc_pin.simulation import Recording

STUDY = """
[study]
repeats = 400
[run]
arm = "two_link"
duration = 1.0
[draws]
mass_scale = { low = 0.9, high = 1.1 }
"""


def wait_for(happened, seconds=200.0):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if happened():
            return
        time.sleep(0.05)
    pytest.fail("it never happened")


def interrupted(process):
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    lines = [line for line in errors.splitlines() if line.strip()]
    assert len(lines) == 1, errors
    return lines[0]


def stat_of(pid):
    """State and parent of a process, None where it is gone."""
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except (FileNotFoundError, ProcessLookupError):
        return None
    return None if words[0] == "Z" else int(words[1])


def children(pid):
    return [
        int(path.name)
        for path in Path("/proc").iterdir()
        if path.name.isdigit() and stat_of(path.name) == pid
    ]


def rows_in(store):
    if not store.is_file():
        return 0
    database = sqlite3.connect(f"file:{store}?mode=ro", uri=True)
    try:
        return database.execute("SELECT count(*) FROM runs").fetchone()[0]
    except sqlite3.Error:
        return 0
    finally:
        database.close()


def test_ctrl_c_keeps_the_run_so_far(started, tmp_path):
    for patience in (1.0, 5.0, 25.0):  # A busy machine may not have begun with the run.
        process = started("simulate", "two_link", "--duration", "2000", "--out", "run")
        wait_for(lambda pid=process.pid: computing(pid))
        time.sleep(patience)
        line = interrupted(process)
        if (tmp_path / "run/run.npz").is_file():
            break
    rec = Recording.load(tmp_path / "run/run.npz")
    assert 1 < len(rec) < 2_000_000
    assert f"t = {rec.t[-1]:.4g} s" in line
    assert "run/run.npz" in line


def computing(pid):
    """Whether the process has loaded its libraries and gone on for a second since."""
    try:
        maps = Path(f"/proc/{pid}/maps").read_text()
        ticks = sum(
            map(int, Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13])
        )
    except (FileNotFoundError, ProcessLookupError):
        return False
    return "libpinocchio_default" in maps and "llvmlite" in maps and ticks > 250


def test_ctrl_c_in_a_search_says_how_to_go_on(started, tmp_path):
    pytest.importorskip("optuna")
    log = tmp_path / "tuned/search.log"
    process = started("tune", "two_link", "--trials", "9999", "--duration", "0.3", "--out", "tuned")
    wait_for(lambda: log.is_file() and log.read_text().count('"values"') > 2)
    line = interrupted(process)
    assert "tuned/search.log" in line
    assert "same command goes on" in line


def test_ctrl_c_in_a_study_says_how_to_go_on_and_stops_its_workers(started, tmp_path):
    (tmp_path / "s.toml").write_text(STUDY)
    process = started("study", "s.toml", "--jobs", "2")
    wait_for(lambda: rows_in(tmp_path / "out/s/study.sqlite") > 2)
    workers = children(process.pid)
    assert len(workers) >= 2
    line = interrupted(process)
    assert "out/s/study.sqlite" in line
    assert "same command goes on" in line
    wait_for(lambda: not any(map(stat_of, workers)), seconds=5.0)


def test_workers_end_with_a_killed_parent_within_5_s(started, tmp_path):
    (tmp_path / "s.toml").write_text(STUDY)
    process = started("study", "s.toml", "--jobs", "2")
    wait_for(lambda: rows_in(tmp_path / "out/s/study.sqlite") > 2)
    workers = children(process.pid)
    assert len(workers) >= 2
    process.kill()
    process.wait()
    wait_for(lambda: not any(map(stat_of, workers)), seconds=5.0)


def test_a_full_disk_is_one_line_that_names_the_file(new_fotsmc, tmp_path):
    def no_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    words = ("simulate", "two_link", "--duration", "2", "--out", "run")
    result = new_fotsmc(*words, preexec_fn=no_room)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    (line,) = result.stderr.splitlines()
    assert "run/run.npz" in line
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


@pytest.mark.parametrize(
    "words",
    [
        ("simulate", "two_link", "--duration", "1e9"),
        ("simulate", "two_link", "--out", "/proc/fotsmc"),
        ("simulate", "two_link", "--delay", "-1"),
        ("tune", "two_link", "--trials", "0"),
        ("tune", "two_link", "--controller", "Nonsense"),
        ("study", "missing.toml"),
        ("stress", "two_link", "--controller", "Nonsense", "--out", "table"),
    ],
)
def test_a_refused_command_is_one_line_and_leaves_no_folder(fotsmc, tmp_path, words):
    result = fotsmc(*words)
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1, result.stderr
    assert not any(tmp_path.iterdir())


def test_a_study_with_a_wrong_gain_ends_before_its_first_run(fotsmc, tmp_path):
    for old, new, says in (
        ('[run]\narm = "two_link"', '[run]\narm = "two_link"\ngains = { thetta = 1.0 }', "theta"),
        ("mass_scale", "mas_scale", "did you mean mass_scale"),
        ("low = 0.9", "low = -0.9", "mass_scale"),
        ('"two_link"', '"two_lnk"', "did you mean two_link"),
    ):
        (tmp_path / "s.toml").write_text(STUDY.replace(old, new))
        result = fotsmc("study", "s.toml")
        assert result.returncode == 2
        assert says in result.stderr
        assert len(result.stderr.splitlines()) == 1
        assert not (tmp_path / "out").exists()
