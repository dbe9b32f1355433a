"""A task where a robot is: drives' conventions, live targets, limits, learning, known friction."""

from itertools import chain, combinations

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import with_known_friction
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.realtime import MujocoRobot
from fotsmc_pin.references import PoseOfJoints, PoseSwing
from tests.robust.safe_stops import Clock

DT = 1e-3
READY = np.array([0.3, -1.2, 1.4, -0.9, 1.2, 0.3])
WORDS = ("gravity", "coriolis", "friction")
CONVENTIONS = [*chain.from_iterable(combinations(WORDS, k) for k in range(4))]


@pytest.fixture(scope="module")
def swing(ur5):
    return PoseSwing(center=ur5.tool_pose(READY), radius=0.05, fade=0.2, q_start=READY)


def follow(controller, robot, clock, reference, ticks):
    """Run a guarded task against a robot whose time the test tells; return its pose errors."""
    errors = []
    for k in range(ticks):
        clock.t = k * DT
        q, v = robot.read()
        controller.update(q, v, *reference(k * DT))
        robot.write(controller.sent)
        errors.append(controller.signals["pose_error"])
    assert controller.stopped is None
    return np.abs(errors)


@pytest.mark.parametrize("compensates", CONVENTIONS, ids="+".join)
def test_a_task_is_done_whatever_the_drives_add(ur5, swing, compensates):
    true, clock = fp.perturb(ur5, mass_scale=1.1, friction=1.0, damping=0.5), Clock()
    robot = MujocoRobot(true, READY, compensates=compensates, believed=ur5, clock=clock)
    guard = fp.Safeguard(fp.TaskSpace(ur5, DT))
    guard.compensates = compensates
    errors = follow(guard, robot, clock, swing, 600)
    assert errors[450:, :3].max() < 1e-3
    assert errors[450:, 3:].max() < 5e-3


def test_limits_and_learning_go_around_a_task_together(ur5, swing):
    true, clock = fp.perturb(ur5, mass_scale=1.1, friction=1.0), Clock()
    robot = MujocoRobot(true, READY, compensates=("gravity",), believed=ur5, clock=clock)
    learner = fp.ModelLearning(fp.TaskSpace(ur5, DT), delay=0, bears=(0.27, 2.5))
    guard = fp.Safeguard(learner, limits=fp.Limits(ur5), torque_rate=2000.0)
    guard.compensates = ("gravity",)
    errors = follow(guard, robot, clock, swing, 600)
    assert errors[400:].max() < 1e-3
    assert learner.signals["learning"].max() == 1.0


def test_a_live_pose_leads_the_tool(ur5):
    live = fp.references.LiveTarget(ur5, q0=READY, timeout=np.inf)
    goal = ur5.tool_pose(READY)
    goal.translation = goal.translation + np.array([0.0, 0.04, 0.02])
    assert live.set_pose(goal) < 1e-5
    clock = Clock()
    robot = MujocoRobot(fp.perturb(ur5, mass_scale=1.1), READY, clock=clock)
    guard = fp.Safeguard(fp.TaskSpace(ur5, DT), limits=fp.Limits(ur5))
    errors = follow(guard, robot, clock, PoseOfJoints(ur5, live), 900)
    assert errors[700:].max() < 1e-3
    away = ur5.tool_pose(robot.read()[0]).translation - goal.translation
    assert np.linalg.norm(away) < 1e-3


def test_a_run_in_real_time_records_what_the_joints_were_to_do(ur5, swing):
    guard = fp.Safeguard(fp.TaskSpace(ur5, DT), watchdog=2.0)
    robot = MujocoRobot(ur5, READY, compensates=("gravity",))
    rec = fp.run_realtime(guard, robot, swing, 0.3, stop_time=0.1).recording
    assert rec.metadata["stopped"] == "the end of the run"
    assert rec.metadata["task"]["frame"] == "tool0"
    followed = rec.signals["stopping"][:, 0] == 0.0
    assert rec.signals["pose_d"].shape == (len(rec), 7)
    errors = np.abs(rec.q - rec.q_d)[followed]
    assert errors.max() < 0.05
    assert np.abs(rec.q_d[followed] - READY).max() > 1e-4


def test_friction_that_is_known_is_fed_forward_to_a_task(ur5, swing):
    true = fp.perturb(ur5, friction=2.0, damping=1.0)
    told = with_known_friction(true)
    worst = {}
    for name, arm in (("told", told), ("not told", ur5)):
        task = fp.TaskSpace(arm, DT, law=fp.ComputedTorque)
        rec = fp.simulate(true, task, swing, 1.0, integrator="semi-implicit")
        worst[name] = np.abs(rec.signals["pose_error"][400:]).max()
    assert worst["told"] < 0.1 * worst["not told"]


def test_a_task_is_not_exported_to_c(ur5, tmp_path):
    for controller in (fp.TaskSpace(ur5, DT), fp.Safeguard(fp.TaskSpace(ur5, DT))):
        with pytest.raises(ArgumentError, match="stays in Python"):
            fp.export_c(controller, tmp_path)
