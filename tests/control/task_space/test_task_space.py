"""`TaskSpace` as a controller: accuracy, singularities, posture, and the face that all have."""

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.control import FrictionCompensation
from fotsmc_pin.control.task_space.tool_rows import OPEN, TASK
from fotsmc_pin.errors import ArgumentError, MeasurementError
from fotsmc_pin.evaluation.stress.task_course import task
from fotsmc_pin.references import PoseArc, PoseHold, PoseMotion, PoseSwing
from fotsmc_pin.simulation import NoisySensor, TickDelay

DT = 1e-3
READY = np.array([0.0, 0.5, 0.0, -1.4, 0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def swing(ur5):
    q = np.array([0.3, -1.2, 1.4, -0.9, 1.2, 0.3])
    return PoseSwing(center=ur5.tool_pose(q), radius=0.06, q_start=q)


def pose_errors(rec, start=0.5):
    """Errors of the true tool from what was asked, way [m] and turn [rad], (n, 2)."""
    rows = range(int(start * len(rec)), len(rec), 5)
    asked = [pin.XYZQUATToSE3(rec.signals["pose_d"][k]) for k in rows]
    found = [rec.arm.tool_pose(rec.q[k]) for k in rows]
    logs = [pin.log6(a.inverse() * b).vector for a, b in zip(asked, found, strict=True)]
    return np.array([[np.linalg.norm(e[:3]), np.linalg.norm(e[3:])] for e in logs])


def rms(errors):
    return np.sqrt((errors**2).mean(axis=0))


def stressed(arm, seed=0):
    true = fp.perturb(arm, mass_scale=1.3, payload=2.0, friction=0.5, damping=0.5)
    sensor = NoisySensor(arm, position=1e-5, velocity=1e-3, seed=seed)
    return true, {
        "sensor": sensor,
        "actuator": TickDelay(1),
        "integrator": "semi-implicit",
        "substeps": 2,
    }


def test_tracks_poses_on_the_stressed_plant(ur5, swing):
    true, loop = stressed(ur5)
    q0 = ur5.integrate(swing.q_start, 0.1 * np.ones(6))
    rec = fp.simulate(true, fp.TaskSpace(ur5, DT), swing, 5.0, q0=q0, **loop)
    way, turn = rms(pose_errors(rec, 0.6))
    assert way < 0.2e-3
    assert turn < 0.7e-3
    assert np.abs(rec.signals["given_up"][-1]).max() < 1e-5


def test_learning_makes_it_five_times_better(ur5, swing):
    true, loop = stressed(ur5)
    ctl = fp.ModelLearning(fp.TaskSpace(ur5, DT), delay=1, bears=(0.27, 2.5))
    rec = fp.simulate(true, ctl, swing, 10.0, **loop)
    way, turn = rms(pose_errors(rec, 0.7))
    assert way < 0.04e-3
    assert turn < 0.1e-3


def test_a_redundant_arm_rests_where_friction_holds_it():
    arm, q0 = fp.load_arm("panda"), np.array([0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8])
    true, loop = stressed(arm)
    rec = fp.simulate(
        true, fp.TaskSpace(arm, DT), PoseHold(pose=arm.tool_pose(q0)), 8.0, q0=q0, **loop
    )
    assert np.ptp(rec.q[4000:], axis=0).max() < 0.2e-3


def test_large_angles_are_closed_on_the_shortest_way(seven):
    goal = seven.tool_pose(READY)
    far = pin.SE3(goal.rotation @ pin.exp3(np.array([0.0, 0.0, 2.8])), goal.translation)
    turns = []
    for target in (far, goal):
        ctl = fp.TaskSpace(seven, DT)
        q0 = READY if target is far else seven.integrate(READY, np.array([0, 0, 0, 0, 0, 0, -2.8]))
        rec = fp.simulate(seven, ctl, PoseHold(pose=target), 5.0, q0=q0)
        assert pose_errors(rec, 0.99).max() < 1e-5
        turns.append(np.abs(np.diff(rec.q[:, 6])).sum())
        # The error in the way is one of the turn's own making, and small.
        assert rec.signals["given_up"][:, :3].max() < 0.05
    assert max(turns) < 3.2


@pytest.mark.parametrize("law", [fp.SuperTwistingSMC, fp.ComputedTorque])
def test_takes_any_law_of_the_library(ur5, swing, law):
    ctl = fp.TaskSpace(ur5, DT, law=law)
    rec = fp.simulate(ur5, ctl, swing, 1.5)
    assert pose_errors(rec, 0.7).max() < 3e-3


@pytest.mark.parametrize("directions", ["position", "pointing", "orientation", "plane"])
def test_holds_fewer_directions(ur5, swing, directions):
    ctl = fp.TaskSpace(ur5, DT, directions=directions)
    rec = fp.simulate(ur5, ctl, swing, 2.0)
    assert rec.signals["s"].shape[1] == len(ctl.directions)
    assert np.abs(rec.signals["pose_error"][1000:]).max() < 3e-4


def test_posture_moves_the_elbow_and_not_the_tool(seven):
    other = READY + np.array([0.6, 0.0, -0.6, 0.0, 0.3, 0.0, 0.0])
    ctl = fp.TaskSpace(seven, DT, posture=other)
    rec = fp.simulate(seven, ctl, PoseHold(pose=seven.tool_pose(READY)), 4.0, q0=READY)
    assert np.abs(rec.q[-1] - rec.q[0]).max() > 0.2
    assert pose_errors(rec, 0.0)[:, 0].max() < 0.1e-3


@pytest.mark.parametrize(("posture_law", "off"), [(None, 1e-2), (fp.RobustFONFTSM, 2e-3)])
def test_posture_holds_and_leaves_the_tool_alone_on_the_stressed_plant(seven, posture_law, off):
    true, loop = stressed(seven)
    other = READY + np.array([0.6, 0.0, -0.6, 0.0, 0.3, 0.0, 0.0])
    still = PoseHold(pose=seven.tool_pose(READY))
    ways = []
    for posture in (READY, other):
        ctl = fp.TaskSpace(seven, DT, posture=posture, posture_law=posture_law)
        rec = fp.simulate(true, ctl, still, 4.0, q0=READY, **loop)
        ways.append(pose_errors(rec, 0.0)[:, 0].max())
        assert np.abs(rec.q - rec.q_d)[2000:].max() < off
    assert np.abs(rec.q[-1] - rec.q[0]).max() > 0.2
    assert ways[1] - ways[0] < 0.1e-3


def test_joints_keep_within_their_ends(seven):
    wanted = PoseHold(pose=seven.tool_pose(READY) * pin.SE3(np.eye(3), np.array([0.0, 0.0, -1.0])))
    ctl = fp.TaskSpace(seven, DT)
    rec = fp.simulate(seven, ctl, wanted, 4.0, q0=READY)
    assert (rec.q <= seven.upper_position_limit + 0.02).all()
    assert (rec.q >= seven.lower_position_limit - 0.02).all()
    assert np.linalg.norm(rec.v[-1]) < 0.1


@pytest.fixture(scope="module")
def stretched(ur5):
    """A circle that touches the end of the arm's reach, passed at 0.1 m/s."""
    q = np.array([0.3, -0.9, 0.0, -0.6, 1.2, 0.3])
    data = ur5.model.createData()
    pin.forwardKinematics(ur5.model, data, q)
    out = data.oMi[4].translation - data.oMi[2].translation
    out /= np.linalg.norm(out)
    axis = np.cross(out, [0.0, 0.0, 1.0])
    axis /= np.linalg.norm(axis)
    touch, radius = ur5.tool_pose(q), 0.15
    center = touch.translation - radius * out
    start = pin.SE3(touch.rotation, center + pin.exp3(-0.75 * axis) @ (radius * out))
    arc = PoseArc(start, center, axis, angle=1.5)
    return PoseMotion(path=arc, duration=1.5 * radius / 0.1 / 0.9, cruise=0.8)


def test_passes_a_stretched_elbow(ur5, stretched):
    from fotsmc_pin.references.poses.inverse import Kinematics

    true, loop = stressed(ur5)
    bent = np.array([0.3, -1.2, 0.6, -0.9, 1.2, 0.3])
    q0 = Kinematics(ur5, ur5.tool_frame_id).solve(stretched(0.0)[0], bent)
    rec = fp.simulate(
        true, fp.TaskSpace(ur5, DT), stretched, stretched.duration + 0.8, q0=q0, **loop
    )
    kept = rec.signals["kept"].min(axis=1)
    assert kept.min() < 0.05
    errors = pose_errors(rec, 0.1)[:, 0]
    assert errors.max() < 5e-3
    back = np.flatnonzero(kept < 1.0)[-1] + 500
    assert pose_errors(rec, back / len(rec))[:, 0].max() < 0.5e-3
    assert np.abs(np.diff(rec.tau[2:], axis=0)).max() < 5.0


def test_what_the_limits_cut_off_does_not_wind_up(ur5, swing):
    weak = fp.load_arm("ur5", effort_limit=[70.0, 70.0, 70.0, 8.0, 8.0, 8.0])
    true = fp.perturb(weak, payload=1.0)
    fast = PoseSwing(center=swing.center, radius=0.06, rate=9.0, fade=0.5, q_start=swing.q_start)

    def reference(t):
        return fast(t) if t < 1.5 else PoseHold(pose=swing.center)(t)

    ctl = fp.TaskSpace(weak, DT)
    rec = fp.simulate(true, ctl, reference, 4.0, q0=swing.q_start)
    assert (np.abs(rec.tau) >= 0.999 * weak.effort_limit).any()
    assert pose_errors(rec, 0.95).max() < 2e-3


def test_another_process_goes_on_bit_for_bit(ur5, swing):
    rng = np.random.default_rng(0)
    ctl = fp.TaskSpace(ur5, DT)
    q, v = swing.q_start.copy(), np.zeros(6)
    for k in range(50):
        ctl.update(q + 1e-4 * rng.normal(size=6), v, *swing(k * DT))
    others = [copy.copy(ctl), copy.deepcopy(ctl), pickle.loads(pickle.dumps(ctl))]
    restored = fp.TaskSpace(ur5, DT)
    restored.restore_state(ctl.save_state())
    for k in range(50, 80):
        q = swing.q_start + 1e-4 * rng.normal(size=6)
        tau = ctl.update(q, v, *swing(k * DT))
        for other in (*others, restored):
            np.testing.assert_array_equal(other.update(q, v, *swing(k * DT)), tau)
    ctl.reset()
    np.testing.assert_array_equal(
        ctl.update(q, v, *swing(0.0)), fp.TaskSpace(ur5, DT).update(q, v, *swing(0.0))
    )


BAD = [
    ("q", 0, [0.0] * 5),
    ("v", 1, [np.nan] * 6),
    ("T", 2, np.eye(3)),
    ("T", 2, np.diag([2.0, 1.0, 1.0, 1.0])),
    ("T", 2, "here"),
    ("V", 3, [0.0] * 3),
    ("A", 4, [np.inf] * 6),
]


@pytest.mark.parametrize(("name", "place", "value"), BAD)
def test_what_cannot_be_used_is_named_and_leaves_the_memory(ur5, swing, name, place, value):
    ctl, twin = fp.TaskSpace(ur5, DT), fp.TaskSpace(ur5, DT)
    good = [swing.q_start, np.zeros(6), *swing(0.0)]
    bad = [*good]
    bad[place] = value
    ctl.update(*good)
    twin.update(*good)
    with pytest.raises(MeasurementError, match=f"^{name}"):
        ctl.update(*bad)
    np.testing.assert_array_equal(ctl.update(*good), twin.update(*good))


def test_takes_matrices_lists_and_motions(ur5, swing):
    T, V, A = swing(0.5)
    q, v = swing.q_start, np.zeros(6)
    tau = fp.TaskSpace(ur5, DT).update(q, v, T, V, A)
    other = fp.TaskSpace(ur5, DT).update(
        q.tolist(), v.tolist(), T.homogeneous.tolist(), pin.Motion(V), A.tolist()
    )
    np.testing.assert_allclose(other, tau, atol=1e-9)


def test_arguments_are_checked(ur5):
    with pytest.raises(ArgumentError, match="frame"):
        fp.TaskSpace(ur5, DT, frame="nowhere")
    with pytest.raises(ArgumentError, match="directions"):
        fp.TaskSpace(fp.load_arm("two_link"), DT)
    with pytest.raises(ArgumentError, match="posture"):
        fp.TaskSpace(ur5, DT, posture=[0.0])
    with pytest.raises(ArgumentError, match="q0"):
        fp.simulate(ur5, fp.TaskSpace(ur5, DT), PoseHold(pose=pin.SE3.Identity()), 1.0)


def test_its_law_alone_is_that_of_a_joint(ur5):
    """So that its margins are too, whatever the directions are."""
    alone = linearize(fp.TaskSpace(ur5, DT).law_alone(), joints=[0])[0]
    plain = linearize(fp.RobustFONFTSM(ur5, DT), joints=[0])[0]
    np.testing.assert_allclose(alone.D, plain.D, rtol=1e-6)
    np.testing.assert_allclose(
        np.sort(np.abs(np.linalg.eigvals(alone.A))),
        np.sort(np.abs(np.linalg.eigvals(plain.A))),
        atol=1e-6,
    )


def test_a_safeguard_stops_it(ur5, swing):
    guard = fp.Safeguard(fp.TaskSpace(ur5, DT), limits=fp.Limits(ur5))
    rec = fp.simulate(ur5, guard, swing, 0.8)
    assert np.abs(rec.signals["pose_error"][-1]).max() < 1e-3
    guard.stop("tested")
    q, v = rec.q[-1], rec.v[-1]
    fastest = np.abs(v).max()
    assert fastest > 0.05
    for k in range(round(0.6 / DT)):
        tau = guard.update(q, v, *swing(0.8 + k * DT))
        v = v + DT * ur5.forward_dynamics(q, v, tau)
        q = ur5.integrate(q, DT * v)
        assert np.abs(v).max() < 1.05 * fastest
    assert np.abs(v).max() < 0.02 * fastest


def test_friction_of_joints_is_not_compensated_by_twists(ur5):
    friction = FrictionCompensation(ur5, friction=1.0)
    with pytest.raises(ArgumentError, match="follows poses"):
        fp.Safeguard(fp.TaskSpace(ur5, DT), friction_compensation=friction)


def test_the_law_is_told_of_the_force_that_acts(ur5, swing):
    """A torque `Jeᵀ F` more than asked is the force `F` more at the tool, as `Λ Je M⁻¹ Jeᵀ = 1`."""
    task = fp.TaskSpace(ur5, DT)
    task.update(swing.q_start, np.zeros(6), *swing(0.3))
    before, tau = task.law.joints.tau.copy(), task.joints.tau.copy()
    force = np.array([3.0, -2.0, 5.0, 0.3, 0.1, -0.2])
    jacobian = task._joints[TASK:OPEN]
    task.note_applied(tau + jacobian.T @ force + 0.5, np.full(6, 0.5))
    np.testing.assert_allclose(task.law.joints.tau - before, force, rtol=1e-8)


def test_the_course_of_the_stress_suite_suits_each_arm(seven, ur5):
    for arm in (seven, ur5):
        course = task(arm, arm)
        assert course.reference.radius > 0.03
