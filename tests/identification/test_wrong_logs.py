"""A log that is not what it should be is refused by the name of its mistake."""

from dataclasses import replace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, LogError
from fotsmc_pin.identification import LogWarning
from fotsmc_pin.identification.diagnosis import demand_sense
from fotsmc_pin.identification.reading import read_logs
from tests.identification import hidden

DURATION = 12.0
NAMES = ("ur5", "so100")


@pytest.fixture(scope="module", params=NAMES)
def case(request):
    arm = fp.load_arm(request.param)
    true = hidden.hidden_plant(arm, 2)
    motion = hidden.swings(arm, 2, duration=DURATION)
    return arm, true, hidden.calculated(true, motion, 2, duration=DURATION)


def judged(arm, log):
    """Return the kind of mistake that a log is refused for, None for none, and the message."""
    (entry,) = read_logs(arm, log)
    try:
        demand_sense(arm, entry)
    except LogError as error:
        return error.kind, str(error)
    return None, ""


def swapped(table, j, k):
    columns = np.arange(table.shape[1])
    columns[[j, k]] = k, j
    return table[:, columns]


def test_a_right_log_is_taken(case):
    arm, _, log = case
    assert judged(arm, log)[0] is None
    assert judged(arm, replace(log, v=None))[0] is None


def test_the_wrong_sign_of_all_torques(case):
    arm, _, log = case
    kind, message = judged(arm, replace(log, tau=-log.tau))
    assert kind == "sign"
    assert "all joints" in message


def test_the_wrong_sign_of_one_torque(case):
    arm, _, log = case
    tau = log.tau.copy()
    tau[:, 1] *= -1.0
    kind, message = judged(arm, replace(log, tau=tau))
    assert kind == "sign"
    assert arm.joint_names[1] in message


def test_swapped_columns_of_torque(case):
    arm, _, log = case
    kind, message = judged(arm, replace(log, tau=swapped(log.tau, 1, 2)))
    assert kind == "columns"
    assert arm.joint_names[1] in message
    assert arm.joint_names[2] in message


def test_swapped_columns_of_everything(case):
    arm, _, log = case
    tables = {name: swapped(getattr(log, name), 0, 1) for name in ("q", "v", "tau")}
    assert judged(arm, replace(log, **tables))[0] in {"columns", "gravity"}
    del tables["v"]
    kind, message = judged(arm, replace(log, **tables))
    assert kind == "columns"
    assert arm.joint_names[0] in message


def test_degrees_for_radians(case):
    arm, _, log = case
    kind, message = judged(arm, replace(log, q=np.degrees(log.q), v=None))
    assert kind == "degrees"
    assert "π/180" in message
    assert judged(arm, replace(log, v=np.degrees(log.v)))[0] == "degrees"


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 9.81), (0.0, 4.9, -8.5)])
def test_gravity_from_another_direction(case, gravity):
    arm, _, log = case
    mounted = fp.load_arm(arm.name, gravity=gravity)
    kind, message = judged(mounted, log)
    assert kind == "gravity"
    told = np.array([float(word) for word in message.split("about (")[1].split(")")[0].split(",")])
    assert np.linalg.norm(told - [0.0, 0.0, -9.81]) < 2.5


@pytest.mark.parametrize("own", ["nominal", "true"])
def test_torque_without_gravity_taken_for_total(case, own):
    arm, true, log = case
    knows = arm if own == "nominal" else true
    free = log.tau - np.array([knows.gravity(q) for q in log.q])
    kind, message = judged(arm, replace(log, tau=free))
    assert kind == "gravity-free"
    assert "compensates" in message


def test_torque_without_gravity_is_taken_where_it_is_said():
    arm = fp.load_arm("ur5")
    true = hidden.hidden_plant(arm, 2)
    log = hidden.calculated(true, hidden.swings(arm, 2, duration=DURATION), 2, duration=DURATION)
    free = log.tau - np.array([arm.gravity(q) for q in log.q])
    said = replace(log, tau=free, compensates=("gravity",))
    assert judged(arm, said)[0] is None
    result = fp.identify(said, arm)
    assert np.allclose(result.theta, fp.identify(log, arm).theta, atol=1e-2)
    assert any("gravity" in note for note in result.notes)
    with pytest.raises(ArgumentError, match="different things by torque"):
        fp.identify([log, said], arm)


def test_too_little_motion(case):
    arm, _, log = case
    still = replace(log, q=np.repeat(log.q[:1], len(log), axis=0), v=0.0 * log.v)
    kind, message = judged(arm, still)
    assert kind == "motion"
    assert arm.joint_names[0] in message


def test_one_joint_that_rests_is_warned_of(case):
    arm, true, log = case
    q, v = log.q.copy(), log.v.copy()
    q[:, -1], v[:, -1] = q[0, -1], 0.0
    a = np.gradient(v, log.t, axis=0)
    tau = np.array([true.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    (entry,) = read_logs(arm, replace(log, q=q, v=v, tau=tau + true.friction * np.sign(v)))
    with pytest.warns(LogWarning, match=arm.joint_names[-1]):
        demand_sense(arm, entry)


def test_a_joint_that_is_missing_is_named():
    arm = fp.load_arm("two_link")
    log = hidden.calculated(arm, hidden.swings(arm, 0, duration=3.0), duration=3.0)
    half = replace(log, q=log.q[:, :1], v=None, tau=log.tau[:, :1], joint_names=("joint1",))
    with pytest.raises(ArgumentError, match="joint2"):
        fp.identify(half, arm)


def test_a_joint_that_shakes_is_warned_of():
    arm = fp.load_arm("two_link")
    motion = hidden.swings(arm, 0, duration=6.0)
    log = hidden.calculated(arm, motion, duration=6.0)
    shaken = log.q + np.array([0.0, 0.02]) * np.sin(60.0 * log.t)[:, None]
    tau = log.tau + 50.0 * np.random.default_rng(0).standard_normal(log.tau.shape)
    with pytest.warns(LogWarning) as caught:
        fp.identify(replace(log, q=shaken, v=None, tau=tau), arm)
    assert any("joint2 stick or shake" in str(warning.message) for warning in caught)


def test_a_motion_that_tells_little_is_warned_of():
    arm = fp.load_arm("ur5")
    small = fp.references.Sinusoid.inside_limits(arm, amplitude=0.03, period=8.0)
    log = hidden.calculated(arm, small, duration=8.0)
    with pytest.warns(LogWarning, match="of 52 base parameters"):
        fp.identify(log, arm)
