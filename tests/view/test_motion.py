"""Frames show the arm where Pinocchio has it, and the camera sees all of it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.view.framing import framing, reach_of
from fotsmc_pin.view.motion import FRAMES_AT_MOST, frame_rows, motion
from fotsmc_pin.view.visuals import visuals_of


@pytest.mark.parametrize("name", ["two_link_true", "panda", "kinova"])
def test_placements_are_those_of_forward_kinematics(name, make_recording):
    recording = make_recording(fp.load_arm(name), duration=1.0, dt=0.05)
    arm = recording.arm
    moved = motion(arm, recording.q)
    data = arm.model.createData()
    for row, q in enumerate(recording.q):
        pin.framesForwardKinematics(arm.model, data, q)
        for joint, placement in enumerate(data.oMi):
            np.testing.assert_allclose(moved.position[row, joint], placement.translation)
            turned = pin.Quaternion(moved.orientation[row, joint]).toRotationMatrix()
            np.testing.assert_allclose(turned, placement.rotation, atol=1e-12)
        tool = data.oMf[arm.tool_frame_id].translation
        np.testing.assert_allclose(moved.tool[row], tool, atol=1e-12)


def test_quaternions_never_jump_to_their_opposites():
    arm = fp.load_arm("two_link")
    turning = np.linspace(0.0, 20.0, 400)
    moved = motion(arm, np.stack([turning, -turning], axis=1))
    assert (np.sum(moved.orientation[1:] * moved.orientation[:-1], axis=-1) > 0.9).all()


@pytest.mark.parametrize("duration", [0.0, 1e-3, 1.0, 1000.0])
def test_any_length_of_run_gives_frames(duration):
    t = np.arange(round(duration * 1000) + 1) * 1e-3
    rows = frame_rows(t, 60.0)
    assert (rows[0], rows[-1]) == (0, len(t) - 1)
    assert (np.diff(rows) > 0).all()
    assert len(rows) <= FRAMES_AT_MOST * 1.5 + 2


def view_of(recording):
    moves = [motion(recording.arm, recording.q[::50])]
    return framing(recording.arm, visuals_of(recording.arm), moves), moves[0]


def test_camera_frames_everything_that_the_tool_sweeps(make_recording):
    view, moved = view_of(make_recording(fp.load_arm("panda")))
    assert (moved.tool >= view.low - 1e-9).all()
    assert (moved.tool <= view.high + 1e-9).all()
    assert (view.outline >= view.low - 1e-9).all()
    assert view.floor <= view.low[2] + 0.05 * view.reach
    assert np.linalg.norm(view.direction) == pytest.approx(1.0)


def test_a_motion_in_a_plane_is_seen_from_the_side(two_link):
    view, moved = view_of(two_link)
    spread = np.ptp(moved.tool, axis=0)
    normal = np.eye(3)[np.argmin(spread)]
    assert abs(view.direction @ normal) > 0.8


def test_reach_is_the_length_of_the_stretched_chain():
    arm = fp.load_arm("two_link")
    stretched = max(
        np.linalg.norm(motion(arm, np.array([[0.3, bend]])).tool[0] - shoulder)
        for bend in np.linspace(-np.pi, np.pi, 2001)
        for shoulder in [motion(arm, np.array([[0.3, bend]])).position[0, 1]]
    )
    assert reach_of(arm) >= stretched - 1e-9
    assert reach_of(arm) == pytest.approx(stretched, rel=0.1)


TURNTABLE = """<robot name="turntable"><link name="base"/><link name="table">
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><cylinder radius="0.6" length="0.05"/></geometry></visual></link>
<joint name="turn" type="continuous"><parent link="base"/><child link="table"/><axis xyz="0 0 1"/>
<limit effort="10" velocity="1"/></joint></robot>"""


def test_a_tool_on_the_only_axis_does_not_shrink_the_scale_of_the_view(make_recording, tmp_path):
    """The floor's grid is drawn to the reach: with none its lines would be millions."""
    (tmp_path / "turntable.urdf").write_text(TURNTABLE)
    arm = fp.load_arm(tmp_path / "turntable.urdf")
    assert reach_of(arm) < 0.02
    view, _ = view_of(make_recording(arm))
    assert view.reach >= 0.25 * np.linalg.norm(view.high - view.low) > 0.2
