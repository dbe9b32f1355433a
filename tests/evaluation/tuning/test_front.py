"""`tune`: the front is one, it survives being killed, and it knows what it searched for."""

import itertools
import subprocess
import sys
import textwrap
from types import SimpleNamespace

import pytest

from fotsmc_pin.control import ComputedTorque
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.tuning import tune

pytest.importorskip("optuna")

START = {"kp": 300.0, "kd": 30.0, "ki": 1000.0}


def trade_off(gains):
    """Errors fall and torques get louder with kp; kd above 80 diverges."""
    if gains["kd"] > 80.0:
        return None
    return SimpleNamespace(
        tail_rms_error=1.0 / gains["kp"],
        rms_error=2.0 / gains["kp"],
        tail_torque_variation=gains["kp"] + abs(gains["kd"] - 40.0),
        peak_torque=gains["kp"],
    )


def test_no_point_of_the_front_beats_another(tmp_path):
    front = tune(ComputedTorque, trade_off, tmp_path / "search.log", start=START, trials=40)
    assert len(front) > 3
    for better, worse in itertools.pairwise(front):
        assert better.error < worse.error
        assert better.torque_variation > worse.torque_variation
    assert all(point.gains["kd"] <= 80.0 for point in front)


def test_the_torque_limit_and_the_objective_are_the_users(tmp_path):
    front = tune(
        ComputedTorque,
        trade_off,
        tmp_path / "search.log",
        start=START,
        trials=30,
        objective="rms_error",
        largest_torque=400.0,
    )
    assert all(point.gains["kp"] <= 400.0 for point in front)
    assert front[0].error == pytest.approx(2.0 / front[0].gains["kp"])


def test_it_goes_on_after_a_kill(tmp_path):
    path = tmp_path / "search.log"
    program = f"""
        import os, sys
        sys.path[:] = {sys.path!r}
        from fotsmc_pin.control import ComputedTorque
        from fotsmc_pin.evaluation.tuning import tune
        from types import SimpleNamespace
        runs = 0
        def run(gains):
            global runs
            runs += 1
            if runs == 6:
                os.kill(os.getpid(), 9)
            return SimpleNamespace(
                tail_rms_error=1.0 / gains["kp"], tail_torque_variation=gains["kp"], peak_torque=1.0
            )
        tune(ComputedTorque, run, {str(path)!r}, start={START!r}, trials=10)
    """
    killed = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], check=False)
    assert killed.returncode == -9
    ran = []

    def count(gains):
        ran.append(gains)
        return trade_off({**gains, "kd": 40.0})

    tune(ComputedTorque, count, path, start=START, trials=10)
    assert len(ran) == 5
    assert tune(ComputedTorque, count, path, start=START, trials=10)
    assert len(ran) == 5


def test_another_search_is_not_mixed_in(tmp_path):
    path = tmp_path / "search.log"
    tune(ComputedTorque, trade_off, path, start=START, trials=2)
    with pytest.raises(ArgumentError, match="another file"):
        tune(ComputedTorque, trade_off, path, start=START, trials=4, objective="rms_error")
    with pytest.raises(ArgumentError, match="objective"):
        tune(ComputedTorque, trade_off, path, start=START, objective="beauty")


ABOUT = {"arm": "panda", "content of the URDF (digest)": "ab12", "duration [s]": 6.0}


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"about": ABOUT | {"arm": "ur5"}}, "its arm is panda, not ur5"),
        (
            {"about": ABOUT | {"content of the URDF (digest)": "cd34"}},
            "digest\\) is ab12, not cd34",
        ),
        ({"about": ABOUT | {"duration [s]": 3.0}}, "its duration \\[s\\] is 6.0, not 3.0"),
        ({"about": {}}, "its arm is panda, not given"),
        ({"seed": 1}, "its seed is 0, not 1"),
        ({"largest_torque": 50.0}, "its largest_torque is None, not 50.0"),
        ({"start": START | {"kp": 200.0}}, "starts from another kp"),
        ({"objective": "rms_error"}, "its objective is tail_rms_error, not rms_error"),
    ],
)
def test_a_search_is_known_by_its_arm_and_every_option(tmp_path, changed, says):
    path = tmp_path / "search.log"
    same = {"start": START, "about": ABOUT}
    tune(ComputedTorque, trade_off, path, trials=2, **same)
    ran = []
    with pytest.raises(ArgumentError, match=says):
        tune(ComputedTorque, ran.append, path, trials=4, **(same | changed))
    assert not ran
    assert tune(ComputedTorque, trade_off, path, trials=3, **same)
