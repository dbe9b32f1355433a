"""Goals that the arm cannot reach: it comes to rest where its tool is nearest to them."""

from functools import partial

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import Bounds, minimize

import fotsmc_pin as fp
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.control.task_space.chain import chain_of
from fotsmc_pin.control.task_space.nearest import boxed_step, curvature
from fotsmc_pin.control.task_space.tool_body import reach
from fotsmc_pin.control.task_space.tool_rows import GoalRows
from fotsmc_pin.references import PoseHold
from fotsmc_pin.simulation import NoisySensor, TickDelay

DT = 1e-3
READY = {
    "ur5": [0.3, -1.2, 1.4, -0.9, 1.2, 0.3],
    "panda": [0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8],
    "z1": [0.2, 1.2, -1.2, 0.3, 0.2, 0.1],
}
DIRECTIONS = {
    "ahead": [1.0, 0.0, 0.4],
    "aside": [0.2, -1.0, 0.3],
    "behind and up": [-0.5, 0.3, 1.0],
}


def beyond(arm, q, direction, way):
    """Return a pose with the tool's own orientation, `way` [m] out of the arm's reach."""
    frame = arm.tool_frame_id
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, q)
    root = arm.model.supports[arm.model.frames[frame].parentJoint][1]
    out = np.array(direction) / np.linalg.norm(direction)
    place = data.oMi[root].translation + (reach(arm, frame) + way) * out
    return pin.SE3(data.oMf[frame].rotation, place)


def lead_only(ctl, q, goal, seconds):
    """Run the feasible reference, with an arm that follows it exactly; return its speeds."""
    q, v, asked = q.copy(), np.zeros(ctl.arm.nv), PoseHold(pose=goal)(0.0)
    speeds = []
    for _ in range(round(seconds / DT)):
        ctl.update(q, v, *asked)
        q, v = ctl._configurations[1].copy(), ctl._p.v.copy()
        speeds.append(v)
    return q, np.array(speeds)


def off(ctl, goal, q):
    """Return the distance from a goal, with rotations made ways [m]."""
    place = ctl.arm.tool_pose(q)
    turn = pin.log3(goal.rotation.T @ place.rotation)
    return np.hypot(
        np.linalg.norm(place.translation - goal.translation), ctl.length * np.linalg.norm(turn)
    )


@pytest.mark.parametrize("name", READY)
@pytest.mark.parametrize("direction", DIRECTIONS)
def test_the_point_comes_to_rest_where_the_tool_is_nearest(name, direction):
    arm = fp.load_arm(name)
    ctl, q0 = fp.TaskSpace(arm, DT), np.array(READY[name])
    for way in (0.1, 0.3, 1.0):
        ctl.reset()
        goal = beyond(arm, q0, DIRECTIONS[direction], way)
        q, speeds = lead_only(ctl, q0, goal, 9.0)
        assert np.abs(speeds[-1000:]).max() < 0.01
        assert (np.abs(speeds) <= arm.velocity_limit).all()
        closed = 0.25 * np.minimum(0.2, 0.1 * (arm.upper_position_limit - arm.lower_position_limit))
        ends = Bounds(arm.lower_position_limit + closed, arm.upper_position_limit - closed)
        best = minimize(partial(off, ctl, goal), q, method="L-BFGS-B", bounds=ends)
        assert off(ctl, goal, q) < best.fun + 2e-3


@pytest.mark.parametrize("name", ["ur5", "z1"])
def test_the_arm_comes_to_rest_with_the_point(name):
    arm, q0 = fp.load_arm(name), np.array(READY[name])
    goal = beyond(arm, q0, DIRECTIONS["ahead"], 0.5)
    ctl, sensor = fp.TaskSpace(arm, DT), NoisySensor(arm, position=1e-5, velocity=1e-3, seed=0)
    rec = fp.simulate(arm, ctl, PoseHold(pose=goal), 6.0, q0=q0, sensor=sensor)
    assert np.abs(rec.v[-1000:]).max() < 0.01
    assert (np.abs(rec.v) < arm.velocity_limit).all()


STRETCHED = {  # Configuration, direction, way [m] and time [s]; the kinova is slow.
    "ur5": ([0.5, -1.9, -1.2, 0.7, 2.1, -0.4], [0.3, 0.6, 0.5], 0.1, 8.0),
    "kinova": ([0.9, 2.6, 1.9, -0.7, 0.4, 1.2], [-0.4, 0.7, 0.2], 0.1, 18.0),
    "panda": ([0.4, -0.7, 0.9, -1.9, -1.1, 2.2, 0.3], [0.9, -0.5, 0.05], 1.0, 8.0),
}


@pytest.mark.parametrize("name", STRETCHED)
def test_the_arm_comes_to_rest_at_its_singularity_whatever_its_masses(name):
    """What the tool gives up is held at the joints, by a law that bears wrong inertias as well."""
    arm = fp.load_arm(name)
    true = fp.perturb(arm, mass_scale=1.3, payload=1.0, friction=0.5, damping=0.5)
    joints, direction, way, seconds = STRETCHED[name]
    q0 = arm.from_joint_positions(joints)
    goal, ctl = beyond(arm, q0, direction, way), fp.TaskSpace(arm, DT)
    rec = fp.simulate(
        true, ctl, PoseHold(pose=goal), seconds, q0=q0,
        sensor=NoisySensor(arm, position=1e-5, velocity=1e-3, seed=0),
        actuator=TickDelay(1), substeps=2, integrator="semi-implicit",
    )  # fmt: skip
    assert rec.signals["kept"].min() < 0.2
    assert np.abs(rec.v[-1000:]).max() < 0.02
    assert (np.abs(rec.v) < 1.02 * arm.velocity_limit).all()


def test_the_curvature_is_no_less_than_that_of_the_way():
    """To second order `|p(q + x) - p_d|²` is at most `|p - p_d|² + 2 fᵀJ x + xᵀ (JᵀJ + C) x`."""
    arm, rng = fp.load_arm("ur5"), np.random.default_rng(0)
    chain = chain_of(arm, arm.tool_frame_id)[0]
    model, data = arm.model, arm.model.createData()
    for _ in range(20):
        q = arm.random_configuration(rng)
        away = rng.normal(size=3)
        J = pin.computeFrameJacobian(
            model, data, q, arm.tool_frame_id, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        pull, C = np.concatenate([away, np.zeros(3)]), np.zeros((6, 6))
        curvature(chain, np.ascontiguousarray(J), pull, C, np.zeros((6, 6)), np.zeros((6, 6)))
        goal = arm.tool_pose(q).translation - away
        for _ in range(20):
            x = 1e-3 * rng.normal(size=6)
            found = np.sum((arm.tool_pose(arm.integrate(q, x)).translation - goal) ** 2)
            told = away @ away + 2.0 * pull @ J @ x + x @ (J[:3].T @ J[:3] + C) @ x
            assert found < told + 1e-8


def test_a_step_within_bounds_is_the_best_one():
    rng = np.random.default_rng(1)
    for n in (1, 3, 7):
        for _ in range(20):
            A = rng.normal(size=(n, n))
            H, table = A @ A.T + 0.01 * np.eye(n), np.zeros((len(GoalRows._fields), n))
            g = named_rows(table, GoalRows)
            g.slope[:] = rng.normal(size=n)
            g.lower[:], g.upper[:] = -rng.uniform(0.01, 1.0, n), rng.uniform(0.01, 1.0, n)
            boxed_step(H, g, np.zeros((n, n)))
            slope = H @ g.step + g.slope
            projected = np.clip(g.step - slope, g.lower, g.upper)
            np.testing.assert_allclose(projected, g.step, atol=1e-9)
