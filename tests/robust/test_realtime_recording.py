"""The recording of a run on a robot: what it holds, and what a crash leaves of it."""

import subprocess
import sys

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import RecordingError
from fotsmc_pin.realtime import MujocoRobot
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import Recording
from fotsmc_pin.simulation.journal import Journal, read_journal
from fotsmc_pin.view.report_tables import facts

pytest.importorskip("mujoco")
DT = 5e-3

KILLED = """
import sys
import fotsmc_pin as fp
from fotsmc_pin.realtime import MujocoRobot
from fotsmc_pin.references import Hold

arm = fp.load_arm("two_link")
controller = fp.Safeguard(fp.RobustFONFTSM(arm, 5e-3), watchdog=10.0)

def tell(t, *_):
    print(t, flush=True)

robot = MujocoRobot(arm, arm.neutral)
fp.run_realtime(controller, robot, Hold(arm), 600.0, record=sys.argv[1], observe=tell)
"""


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


@pytest.fixture(scope="module")
def run(arm, tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.npz"
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, DT), watchdog=10.0)
    robot = MujocoRobot(arm, arm.integrate(arm.neutral, [0.1, -0.1]), compensates=("gravity",))
    done = fp.run_realtime(controller, robot, Hold(arm), 0.6, stop_time=0.1, record=path)
    return done, path


def test_it_holds_what_was_measured_wanted_and_sent(arm, run):
    rec, timing = run[0].recording, run[0].timing
    assert len(rec) == timing.ticks
    np.testing.assert_allclose(np.diff(rec.t), rec.signals["period"][1:, 0], atol=1e-12)
    np.testing.assert_allclose(rec.e[0], [0.1, -0.1], atol=1e-9)
    gravity = np.array([arm.gravity(q) for q in rec.q])
    np.testing.assert_allclose(rec.tau - rec.signals["sent"], gravity, atol=1e-9)
    # The drives add gravity as the arm moves on, the declaration as it was at the tick.
    # Of a tick that a busy machine drew out, gravity is another at its end.
    periods = rec.signals["period"][:, 0]
    short = np.maximum(periods, np.append(periods[1:], np.inf)) < 5.0 * DT
    np.testing.assert_allclose(rec.tau_measured[short], rec.tau[short], atol=0.5)
    assert {"s", "z"} <= set(rec.signals)
    stopping = rec.signals["stopping"][:, 0]
    assert stopping[0] == 0.0
    assert stopping[-1] == 1.0
    assert rec.metadata["stopped"] == "the end of the run"
    assert rec.metadata["compensates"] == ["gravity"]


def test_its_file_is_an_ordinary_recording(run):
    (done, path) = run
    loaded = Recording.load(path)
    assert path.read_bytes().startswith(b"PK")
    np.testing.assert_array_equal(loaded.tau_measured, done.recording.tau_measured)
    np.testing.assert_array_equal(loaded.signals["sent"], done.recording.signals["sent"])
    assert loaded.metadata["timing"]["ticks"] == done.timing.ticks


def test_a_report_shows_why_and_how_it_ran(run):
    page = facts({"run": Recording.load(run[1])})
    for words in ("stopped", "the end of the run", "compensates", "MujocoRobot", "missed"):
        assert words in page


def test_a_killed_run_loses_a_tenth_of_a_second_at_most(tmp_path):
    path = tmp_path / "killed.npz"
    command, lines = [sys.executable, "-c", KILLED, str(path)], []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        for line in program.stdout:
            lines.append(float(line))
            if lines[-1] > 0.5:
                break
        program.kill()  # SIGKILL: nothing of it can be caught.
        lines += [float(line) for line in program.stdout if line.endswith("\n")]
    assert program.returncode == -9
    rec = Recording.load(path)
    assert rec.t[-1] >= lines[-1] - 0.1
    assert len(rec) >= len(lines)
    np.testing.assert_allclose(rec.t[: len(lines)], lines)
    assert "before the run did" in rec.metadata["stopped"]
    assert rec.e.shape == (len(rec), 2)


def test_a_journal_is_read_as_far_as_it_goes(tmp_path):
    journal = Journal(tmp_path / "j", {}, 5, 2)
    journal.table[0, :2] = 1.0, 2.0
    journal.end_row()
    journal.table[1, :2] = 3.0, 4.0  # A row that was not completed.
    with open(tmp_path / "j", "rb") as stream:
        _, reason, rows = read_journal(stream)
    np.testing.assert_array_equal(rows, [[1.0, 2.0]])
    assert reason == ""


def test_a_damaged_journal_is_told_as_such(tmp_path):
    path = tmp_path / "damaged.npz"
    path.write_bytes(b"FOTSMCJ1" + b"\0" * 300)
    with pytest.raises(RecordingError, match="damaged"):
        Recording.load(path)
