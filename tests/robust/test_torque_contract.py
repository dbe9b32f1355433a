"""What a commanded torque means: drives that add gravity, Coriolis torque or friction."""

import copy

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import FrictionCompensation
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.realtime import MujocoRobot
from fotsmc_pin.references import Sinusoid
from tests.robust.safe_stops import CONVENTIONS, Clock, stop_once

DT = 1e-3


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


def follow(controller, robot, clock, reference, ticks):
    """Run a controller against a robot whose time the test tells; return what happened."""
    rows = []
    for k in range(ticks):
        clock.t = k * DT
        q, v = robot.read()
        tau = controller.update(q, v, *reference(k * DT))
        robot.write(controller.sent)
        rows.append((q, v, tau, controller.sent, robot.read_torque()))
    return [np.array(column) for column in zip(*rows, strict=True)]


@pytest.mark.parametrize("compensates", CONVENTIONS[::2], ids="+".join)
def test_the_arm_is_followed_alike_whatever_the_drives_add(arm, compensates):
    true, clock = fp.perturb(arm, mass_scale=1.1, friction=2.0, damping=1.0), Clock()
    reference = Sinusoid.inside_limits(arm)
    robot = MujocoRobot(true, reference(0.0)[0], compensates=compensates, believed=arm, clock=clock)
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, DT), soft_start=0.3)
    controller.compensates = compensates
    q, v, tau, sent, acting = follow(controller, robot, clock, reference, 900)
    errors = [arm.difference(reference(k * DT)[0], row) for k, row in enumerate(q)]
    assert np.abs(errors[500:]).max() < 2e-3
    assert controller.stopped is None
    # What acted is what the law asked for; the drives' model is a tick younger than ours.
    np.testing.assert_allclose(acting[1:], tau[:-1], atol=3.0)
    added = np.zeros_like(tau)
    for k in range(len(q)):
        if "gravity" in compensates:
            added[k] += arm.gravity(q[k])
        if "coriolis" in compensates:
            added[k] += arm.coriolis(q[k], v[k]) @ v[k]
    np.testing.assert_allclose(sent, tau - added, atol=1e-9)


def test_without_the_declaration_a_compensating_arm_is_thrown(arm):
    """The fault that the declaration is for: gravity twice."""
    clock = Clock()
    robot = MujocoRobot(arm, arm.neutral, compensates=("gravity",), clock=clock)
    for k in range(300):
        clock.t = k * DT
        q, v = robot.read()
        robot.write(arm.gravity(q) - 10.0 * np.diag(arm.mass_matrix(q)) * v)
    assert np.abs(v).max() > 0.2


@pytest.mark.parametrize("rate", [None, 300.0])
def test_the_limits_hold_for_what_is_sent_and_for_the_total(rate):
    arm = fp.load_arm("two_link", effort_limit=[60.0, 25.0])
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, DT), soft_start=0.0, torque_rate=rate)
    controller.compensates = ("gravity",)
    rng, totals, sent = np.random.default_rng(1), [], []
    q = np.array([0.3, 0.2])
    for _ in range(300):
        q = q + 1e-4 * rng.standard_normal(2)
        target = q + rng.standard_normal(2)
        totals.append(controller.update(q, np.zeros(2), target, np.zeros(2), np.zeros(2)))
        sent.append(controller.sent)
    limit = arm.effort_limit * (1.0 + 1e-12)
    for rows in (np.array(totals), np.array(sent)):
        assert (np.abs(rows) <= limit).all()
        if rate is not None:
            assert (np.abs(np.diff(rows, axis=0)) <= rate * DT + 1e-9).all()
    assert (np.abs(np.array(sent)) > 0.99 * arm.effort_limit).any() or rate is not None


@pytest.mark.parametrize("hides", [True, False])
def test_drives_that_compensate_friction_leave_none(arm, hides):
    true, clock = fp.perturb(arm, friction=2.0, damping=1.0), Clock()
    words = ("gravity", "friction") if hides else ("gravity",)
    robot = MujocoRobot(true, arm.neutral, v0=[1.0, -0.5], compensates=words, clock=clock)
    energies = []
    for clock.t in (0.0, 0.04):
        q, v = robot.read()
        energies.append(v @ true.mass_matrix(q) @ v)
    if hides:
        assert energies[1] == pytest.approx(energies[0], rel=5e-3)
    else:
        assert energies[1] < 0.98 * energies[0]


def test_friction_is_not_compensated_twice(arm):
    compensation = FrictionCompensation(arm, friction=5.0)
    torques = []
    for words in ((), ("friction",)):
        guarded = fp.Safeguard(
            fp.RobustFONFTSM(arm, DT), soft_start=0.0, friction_compensation=compensation
        )
        guarded.compensates = words
        v = np.ones(2)
        torques.append(guarded.update(arm.neutral, v, arm.neutral, v, np.zeros(2)))
    np.testing.assert_allclose(torques[0] - torques[1], [5.0, 5.0], atol=1e-9)


def test_friction_that_a_law_knows_is_left_to_drives_that_hide_it(arm, monkeypatch):
    monkeypatch.setattr(type(arm), "friction_is_known", True)
    known = fp.perturb(arm, friction=5.0)
    torques = []
    for words in (("friction",), (), ("friction",)):
        guarded = fp.Safeguard(fp.ComputedTorque(known, DT), soft_start=0.0)
        guarded.compensates = words
        v = np.ones(2)
        state = (arm.neutral, v, arm.neutral, v, np.zeros(2))
        twin = copy.deepcopy(guarded)
        torques.append(guarded.update(*state))
        np.testing.assert_array_equal(twin.update(*state), torques[-1])
    np.testing.assert_allclose(torques[1] - torques[0], [5.0, 5.0], atol=1e-9)
    np.testing.assert_array_equal(torques[0], torques[2])


def test_the_law_and_the_estimator_are_told_what_acts(arm):
    """A rate limit cuts the torque after the law: observer and estimator get what is left."""
    law = fp.ModelLearning(fp.RobustFONFTSM(arm, DT), delay=1)
    guarded = fp.Safeguard(law, soft_start=0.0, torque_rate=100.0)
    q, v = arm.neutral, np.zeros(2)
    tau = guarded.update(q, v, q + 0.3, v, v)
    np.testing.assert_allclose(np.abs(tau), 0.1, atol=1e-12)
    np.testing.assert_array_equal(law._sent[1], tau)
    np.testing.assert_array_equal(law.controller.joints.tau, tau)


def test_learning_finds_the_payload_on_an_arm_that_adds_gravity(arm):
    """The estimator needs the total torque: from what is sent it would find no weight at all."""
    true, clock = fp.perturb(arm, payload=2.0), Clock()
    found = []
    for words in ((), ("gravity",)):
        law = fp.ModelLearning(fp.RobustFONFTSM(arm, DT), delay=0)
        guarded = fp.Safeguard(law, soft_start=0.3)
        guarded.compensates = words
        reference, clock = Sinusoid.inside_limits(arm), Clock()
        start = reference(0.0)[0]
        robot = MujocoRobot(true, start, compensates=words, believed=arm, clock=clock)
        follow(guarded, robot, clock, reference, 2000)
        scale = guarded.signals
        found.append(np.concatenate([scale["link_scale"], scale["payload"][:1]]))
    np.testing.assert_allclose(found[0], found[1], atol=0.1)


@pytest.mark.parametrize("missing", ["compensates", "paced"])
def test_a_robot_that_does_not_declare_itself_is_refused(arm, missing):
    class Silent:
        def read(self):
            raise AssertionError("it must not be run")

        write = read

    robot = Silent()
    if missing == "paced":
        robot.compensates = ()
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, DT))
    with pytest.raises(ArgumentError, match=f"give it `{missing}`"):
        fp.run_realtime(controller, robot, Sinusoid.inside_limits(arm), 1.0)


def test_unknown_words_are_refused(arm):
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, DT))
    with pytest.raises(ArgumentError, match="weight"):
        controller.compensates = ("weight",)
    with pytest.raises(ArgumentError, match="tuple"):
        controller.compensates = "gravity"


def test_a_robot_that_keeps_the_clock_is_not_waited_for(arm):
    robot = MujocoRobot(arm, arm.neutral, paced=True, period=5e-3)
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, 5e-3), watchdog=10.0)
    run = fp.run_realtime(controller, robot, Sinusoid.inside_limits(arm), 0.4, stop_time=0.1)
    assert run.timing.ticks <= 105
    assert run.timing.period > 0.95 * 5e-3
    assert controller.stopped == "the end of the run"


def test_a_robot_that_ticks_faster_than_the_controller_is_stopped(arm):
    robot = MujocoRobot(arm, arm.neutral, paced=True, period=1e-3)
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, 2e-2), watchdog=10.0)
    run = fp.run_realtime(controller, robot, Sinusoid.inside_limits(arm), 3.0, stop_time=0.1)
    assert "faster than the controller's dt" in run.timing.stopped


def test_a_coarse_and_late_robot(arm):
    clock, step = Clock(), 1e-3
    robot = MujocoRobot(arm, arm.neutral, delay=3, quantisation=step, clock=clock)
    for k in range(40):
        clock.t = k * DT
        q, _ = robot.read()
        np.testing.assert_allclose(q / step, np.round(q / step), atol=1e-9)
        robot.write(np.full(2, float(k + 1)))
        # The torque of the write before last but two.
        np.testing.assert_array_equal(robot.read_torque(), max(k - 3, 0) * (k > 0))


@pytest.mark.parametrize(
    ("compensates", "trust_law"),
    [((), True), (("gravity", "friction"), True), (("gravity", "friction"), False)],
)
def test_a_safe_stop_from_full_speed_with_an_unknown_payload(compensates, trust_law):
    stop = stop_once("panda", compensates, seed=0, trust_law=trust_law)
    assert stop.rest < 1.0
    assert stop.way < 0.3
    assert stop.speed < 1.05
    assert stop.by_law == trust_law
