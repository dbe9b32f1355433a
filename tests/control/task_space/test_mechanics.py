"""What the law is told of the tool is what the arm does: mechanics against forward dynamics."""

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.task_space.chain import chain_motion, chain_of
from fotsmc_pin.control.task_space.mobility import eigen, factor, task_inertia
from fotsmc_pin.control.task_space.sharing import act
from fotsmc_pin.control.task_space.tool_rows import JACOBIAN, JACOBIAN_T, TASK
from fotsmc_pin.references import PoseSwing

DT = 1e-3


@pytest.fixture(scope="module", params=["ur5", "seven"])
def arm(request):
    return request.getfixturevalue(request.param)


def states(arm, count=14):
    rng = np.random.default_rng(1)
    for _ in range(count):
        q = arm.random_configuration(rng)
        near = arm.integrate(q, 0.1 * rng.normal(size=arm.nv))
        yield q, rng.normal(size=arm.nv), swing_at(arm, near)


def swing_at(arm, q):
    return PoseSwing(center=arm.tool_pose(q), radius=0.1, fade=0.1)


def tick(ctl, q, v, q_f, v_f, wanted):
    """Run one tick with the arm in one state and the feasible reference in another."""
    ctl.reset()
    ctl._n.begun[0] = 1.0
    ctl._configurations[1] = ctl._configurations[2] = q_f
    ctl._p.v[:] = v_f
    ctl.update(q, v, *wanted)
    return ctl.law.joints


@pytest.mark.parametrize("directions", ["all", "pointing", "plane"])
def test_the_law_is_told_how_the_error_moves(arm, directions):
    """`ė` is the derivative of `e`, and a force `F` makes `ë = Λ⁻¹ (F - h) - a_d`."""
    rng, h = np.random.default_rng(2), 1e-5
    ctl, tested = fp.TaskSpace(arm, DT, directions=directions), 0
    m, n = len(ctl.directions), arm.nv
    for q, v, swing in states(arm):
        q_f = arm.integrate(q, 0.3 * rng.normal(size=n))
        v_f = rng.normal(size=n)
        seen = tick(ctl, q, v, q_f, v_f, swing(1.0))
        if ctl.signals["kept"].min() < 1.0:
            continue
        tested += 1
        e_dot, a_d, a_f = seen.e_dot.copy(), seen.a_d.copy(), ctl._p.a.copy()
        Lambda, drift = ctl._mobility.copy(), ctl._drift.copy()
        Je = ctl._joints[TASK : TASK + m].copy()
        F = rng.normal(size=m)
        tau = Je.T @ F + arm.inverse_dynamics(q, v, np.zeros(n))
        a = arm.forward_dynamics(q, v, tau)
        errors, rates = [], []
        for side in (-h, h):
            near = tick(
                ctl,
                arm.integrate(q, side * v + 0.5 * h * h * a),
                v + side * a,
                arm.integrate(q_f, side * v_f + 0.5 * h * h * a_f),
                v_f + side * a_f,
                swing(1.0),
            )
            errors.append(near.e.copy())
            rates.append(near.e_dot.copy())
        np.testing.assert_allclose((errors[1] - errors[0]) / (2 * h), e_dot, rtol=1e-6, atol=1e-6)
        e_ddot = np.linalg.solve(Lambda, F - drift) - a_d
        np.testing.assert_allclose((rates[1] - rates[0]) / (2 * h), e_ddot, rtol=1e-5, atol=1e-4)
    assert tested >= 3


def test_posture_does_not_accelerate_the_tool(seven):
    rng = np.random.default_rng(3)
    ctl = fp.TaskSpace(seven, DT)
    for q, v, swing in states(seven):
        ctl.reset()
        ctl.update(q, v, *swing(1.0))
        if ctl.signals["kept"].min() < 1.0:
            continue
        h, force = ctl._terms.h.copy(), ctl.law.joints.tau.copy()
        ctl.joints.effort_limit[:] = np.inf
        accelerations = []
        for push in (0.0, 30.0):
            ctl.law.joints.tau[:] = force
            ctl.posture_law.joints.tau[:] = h + push * rng.normal(size=7)
            act(*ctl._last)
            a = seven.forward_dynamics(q, v, ctl.joints.tau)
            accelerations.append(ctl._joints[JACOBIAN:JACOBIAN_T] @ a)
        assert np.abs(accelerations[1] - accelerations[0]).max() < 1e-8
        ctl._set_constants()


def test_nothing_changes_in_another_frame_of_the_world(seven, tmp_path):
    turn = pin.SE3(pin.rpy.rpyToMatrix(0.7, -0.4, 1.1), np.array([0.3, -1.2, 0.8]))
    rpy = " ".join(map(repr, pin.rpy.matrixToRpy(turn.rotation).tolist()))
    xyz = " ".join(map(repr, turn.translation.tolist()))
    text = seven.urdf.replace(
        '<link name="base"',
        '<link name="ground" /><joint name="mount" type="fixed"><parent link="ground"/>'
        f'<child link="base"/><origin xyz="{xyz}" rpy="{rpy}"/></joint><link name="base"',
        1,
    )
    path = tmp_path / "mounted.urdf"
    path.write_text(text)
    free = {"gravity": [0.0, 0.0, 0.0]}
    plain = tmp_path / "plain.urdf"
    plain.write_text(seven.urdf)
    one, two = (fp.TaskSpace(fp.load_arm(p, **free), DT) for p in (plain, path))
    rng = np.random.default_rng(4)
    q, v = seven.random_configuration(rng), 0.1 * rng.normal(size=7)
    swing = swing_at(one.arm, seven.integrate(q, 0.05 * np.ones(7)))
    assert two.arm.tool_pose(q).isApprox(turn * one.arm.tool_pose(q), 1e-9)
    for k in range(300):
        T, V, A = swing(k * DT)
        tau = one.update(q, v, T, V, A)
        twin = two.update(q, v, turn * T, V, A)
        assert np.abs(tau - twin).max() < 1e-9 * (1.0 + np.abs(tau).max())
        q, v = seven.integrate(q, DT * v), v + DT * 0.1 * rng.normal(size=7)


@pytest.mark.parametrize("name", ["panda", "kinova", "sliding"])
def test_the_chain_moves_as_pinocchio_says(name, tmp_path, seven):
    if name == "sliding":
        path = tmp_path / "sliding.urdf"
        path.write_text(seven.urdf.replace('type="revolute"', 'type="prismatic"', 2))
        arm = fp.load_arm(path)
    else:
        arm = fp.load_arm(name)
    frame, rng = arm.tool_frame_id, np.random.default_rng(7)
    data, local = arm.model.createData(), pin.ReferenceFrame.LOCAL
    pose, J, twist, bias = np.zeros((4, 3)), np.zeros((6, arm.nv)), np.zeros(6), np.zeros(6)
    for _ in range(10):
        q, v = arm.random_configuration(rng), rng.normal(size=arm.nv)
        chain_motion(*chain_of(arm, frame), q, v, pose, J, twist, bias)
        expected = pin.computeFrameJacobian(arm.model, data, q, frame, local)
        np.testing.assert_allclose(J, expected, atol=1e-12)
        pin.forwardKinematics(arm.model, data, q, v, np.zeros(arm.nv))
        place = pin.updateFramePlacement(arm.model, data, frame)
        drift = pin.getFrameAcceleration(arm.model, data, frame, local).vector
        np.testing.assert_allclose(pose[:3], place.rotation, atol=1e-12)
        np.testing.assert_allclose(pose[3], place.translation, atol=1e-12)
        np.testing.assert_allclose(twist, expected @ v, atol=1e-12)
        np.testing.assert_allclose(bias, drift, atol=1e-11)


def test_eigenvalues_are_those_of_numpy():
    rng = np.random.default_rng(5)
    for n in (1, 2, 6):
        A = rng.normal(size=(n, n))
        A = A @ A.T
        work, U = A.copy(), np.zeros((n, n))
        eigen(work, n, U)
        np.testing.assert_allclose(U @ np.diag(np.diag(work)) @ U.T, A, atol=1e-10)
        np.testing.assert_allclose(np.sort(np.diag(work)), np.linalg.eigvalsh(A), atol=1e-10)


def test_damping_acts_only_near_a_singularity_and_is_bounded_there():
    rng = np.random.default_rng(6)
    n, m, threshold = 7, 6, 0.1
    U, V = (np.linalg.qr(rng.normal(size=(k, k)))[0] for k in (m, n))
    M = np.eye(n) + 0.5 * np.diag(rng.uniform(size=n))
    L = np.zeros((n, n))
    factor(M, n, L)
    largest, before = [], None
    for smallest in np.linspace(0.2, 0.0, 400):
        J = U @ np.hstack([np.diag([1.0, 0.8, 0.6, 0.5, 0.4, smallest]), np.zeros((m, 1))]) @ V.T
        Lambda = np.zeros((m, m))
        kept = task_inertia(
            J, L, m, np.ones(m), threshold, np.zeros((n, n)), Lambda, np.zeros((30, 6))
        )
        if smallest > threshold:
            assert kept == 1.0
            exact = np.linalg.inv(J @ np.linalg.solve(M, J.T))
            np.testing.assert_allclose(Lambda, exact, rtol=1e-9, atol=1e-12)
        largest.append(np.linalg.norm(Lambda, 2))
        if before is not None:
            assert np.linalg.norm(Lambda - before, 2) < 0.05 * np.linalg.norm(Lambda, 2)
        before = Lambda
    assert max(largest) < 4.0 / threshold**2
    assert kept == 0.0
