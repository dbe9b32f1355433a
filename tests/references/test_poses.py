"""References of poses: twists and their rates are derivatives, and limits are kept."""

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import (
    PoseArc,
    PoseHold,
    PoseLine,
    PoseMotion,
    PoseOfJoints,
    PoseScrew,
    PoseSwing,
    PoseWaypoints,
)

H = 1e-5
UR5 = fp.load_arm("ur5")
Q = np.array([0.3, -1.2, 1.4, -0.9, 1.2, 0.3])


def pose(turn, way):
    return pin.SE3(pin.exp3(np.array(turn)), np.array(way))


A, B, C = (
    pose([0.1, 0.2, 0.3], [0.3, 0.1, 0.5]),
    pose([0.9, -0.4, 0.3], [0.5, 0.1, 0.4]),
    pose([0.5, 0.8, -0.3], [0.5, 0.4, 0.6]),
)
PATHS = {
    "line": PoseLine(A, B),
    "screw": PoseScrew(A, B),
    "arc": PoseArc(A, [0.2, 0.0, 0.5], [0.1, 0.2, 1.0], 2.0),
    "turning arc": PoseArc(A, [0.2, 0.0, 0.5], [0.1, 0.2, 1.0], 2.0, turning=True),
    "waypoints": PoseWaypoints([A, B, C], blend=0.08),
}
REFERENCES = {
    **{name: PoseMotion(path=path, duration=2.0) for name, path in PATHS.items()},
    **{f"{n}, cruised": PoseMotion(path=p, duration=2.0, cruise=0.5) for n, p in PATHS.items()},
    "swing": PoseSwing(center=A),
    "hold": PoseHold(pose=A),
    "joints": PoseOfJoints(UR5, fp.references.Sinusoid.inside_limits(UR5)),
}


@pytest.mark.parametrize("name", REFERENCES)
def test_twists_are_derivatives(name):
    reference = REFERENCES[name]
    for t in np.linspace(0.01, 2.3, 47):
        _, V, rate = reference(t)
        ahead, behind = reference(t + H), reference(t - H)
        moved = pin.log6(behind[0].inverse() * ahead[0]).vector / (2 * H)
        np.testing.assert_allclose(moved, V, atol=1e-7)
        np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * H), rate, atol=2e-4)


@pytest.mark.parametrize("name", PATHS)
def test_a_motion_goes_from_rest_to_rest(name):
    reference = REFERENCES[name]
    for t in (-1.0, 0.0, 2.0, 5.0):
        _, V, rate = reference(t)
        assert not V.any()
        assert not rate.any()
    start, end = reference(0.0)[0], reference(2.0)[0]
    assert start.isApprox(PATHS[name].at(0.0)[0])
    assert end.isApprox(PATHS[name].at(1.0)[0])


def test_waypoints_are_passed_within_the_blend():
    path = PATHS["waypoints"]
    places = [path.at(s)[0] for s in np.linspace(0.0, 1.0, 2001)]
    nearest = min(np.linalg.norm(place.translation - B.translation) for place in places)
    assert nearest < 0.08 * 5.0 / 16.0 * 2.0
    assert places[-1].isApprox(C, 1e-9)


def test_times_keep_to_every_limit():
    arm = fp.load_arm("ur5")
    start = arm.tool_pose(Q)
    end = start * pose([0.0, 0.0, 0.6], [0.1, 0.0, 0.05])
    limits = {"speed": 0.2, "acceleration": 0.8, "angular_speed": 0.7, "angular_acceleration": 3.0}
    motion = PoseMotion.timed(PoseLine(start, end), arm, q=Q, **limits)
    np.testing.assert_allclose(motion.q_start, Q, atol=1e-6)
    rows = [motion(t) for t in np.linspace(0.0, motion.duration, 400)]
    shares = [
        max(np.linalg.norm(V[:3]) for _, V, _ in rows) / 0.2,
        max(np.linalg.norm(V[3:]) for _, V, _ in rows) / 0.7,
        max(np.linalg.norm(a[:3] + np.cross(V[3:], V[:3])) for _, V, a in rows) / 0.8,
        max(np.linalg.norm(a[3:]) for _, _, a in rows) / 3.0,
    ]
    assert max(shares) == pytest.approx(1.0, abs=2e-3)
    slow = PoseMotion.timed(PoseLine(start, end), arm, q=Q, velocity_limit=0.1)
    assert slow.duration > 1.5 * motion.duration


def test_what_cannot_be_done_is_refused():
    arm = fp.load_arm("ur5")
    start = arm.tool_pose(Q)
    far = pin.SE3(start.rotation, start.translation + np.array([2.0, 0.0, 0.0]))
    with pytest.raises(ArgumentError, match="does not get there"):
        PoseMotion.timed(PoseLine(start, far), arm, q=Q)
    with pytest.raises(ArgumentError, match="half a turn"):
        PoseLine(A, A * pose([3.14, 0.0, 0.0], [0.1, 0.0, 0.0]))
    with pytest.raises(ArgumentError, match="the same"):
        PoseWaypoints([A, A])
    with pytest.raises(ArgumentError, match="axis"):
        PoseArc(A, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    with pytest.raises(ArgumentError, match="rotation"):
        PoseHold(pose=2.0 * np.eye(4))


def test_a_live_target_leads_a_tool():
    """`set_pose` at any time: the tool follows, and comes to the pose."""
    live = fp.references.LiveTarget(UR5, q0=Q, timeout=10.0)
    reference = PoseOfJoints(UR5, live)
    goal = UR5.tool_pose(Q) * pose([0.0, 0.0, 0.2], [0.03, -0.02, 0.04])
    live.set_pose(goal)
    rec = fp.simulate(UR5, fp.TaskSpace(UR5, dt=2e-3), reference, 2.0)
    assert np.abs(pin.log6(goal.inverse() * UR5.tool_pose(rec.q[-1])).vector).max() < 1e-3
    assert np.abs(pin.log6(goal.inverse() * UR5.tool_pose(rec.q[0])).vector).max() > 0.03


def test_a_frame_that_is_none_is_refused():
    with pytest.raises(ArgumentError, match="frame"):
        PoseOfJoints(UR5, fp.references.Hold(UR5), frame="nothing")
