"""Where the tool is: by name, by its place in the tree, or placed beyond the last joint."""

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import inspect_arm, load_arm

FINGER = '<limit lower="0" upper="0.05" effort="5" velocity="1"/>'


def distance(arm):
    """Of the tool frame from the origin of the last moving joint before it [m]."""
    return np.linalg.norm(arm.model.frames[arm.tool_frame_id].placement.translation)


@pytest.mark.parametrize(
    ("name", "frame", "least"),
    [
        ("panda", "panda_hand_tcp", 0.2),
        ("ur5", "tool0", 0.08),
        ("kinova", "j2s6s200_end_effector", 0.15),
        ("z1", "gripperStator", 0.05),
        ("so101", "gripper_frame_link", 0.09),
        ("talos_arm", "wrist_left_ft_tool_link", 0.06),
        ("baxter", "left_gripper", 0.27),
        ("so100", "tool_point", 0.06),
        ("double_pendulum", "tool_point", 0.15),
        ("xarm7", "link_eef", 0.0),
    ],
)
def test_known_arms_have_their_tool_beyond_the_last_joint(name, frame, least):
    arm = load_arm(name)
    assert arm.tool_frame == frame
    assert distance(arm) >= least


def gripper(made, *, pads=False):
    """Two links and a gripper whose palm is the second link, with its frame at the elbow."""
    side = {"left": "0.3 0.02 0", "right": "0.3 -0.02 0"}
    parts = []
    for name, origin in side.items():
        joint = made.joint(f"{name}_finger_joint", "link2", name, "prismatic", extra=FINGER)
        parts += [
            made.link(name, mass=0.01),
            joint.replace("0.4 0 0", origin).replace("0.1 0.2 0.3", "0 0 0"),
        ]
        if pads:
            glue = made.joint(f"{name}_pad_joint", name, f"{name}_pad", "fixed", extra="")
            parts += [f'<link name="{name}_pad"/>', glue.replace("0.4 0 0", "0.2 0 0")]
    return made.chain("revolute", "revolute", tail=parts)


def test_locked_fingers_put_the_tool_between_them(made):
    arm = load_arm(gripper(made))
    assert arm.tool_frame == "tool_point"
    frame = arm.model.frames[arm.tool_frame_id]
    assert arm.model.names[frame.parentJoint] == "joint2"
    # The centre of mass lies near 0.2 m, so twice that is farther than the fingers' 0.3 m.
    assert 0.35 < distance(arm) < 0.45
    assert any("tool_point was placed" in note and "tool_frame" in note for note in arm.notes)


def test_pads_are_the_ends_of_the_fingers(made):
    arm = load_arm(gripper(made, pads=True))
    np.testing.assert_allclose(
        arm.model.frames[arm.tool_frame_id].placement.translation, [0.5, 0.0, 0.0], atol=1e-12
    )
    assert "half-way between the ends of its fingers" in "\n".join(arm.notes)


def test_a_bare_last_link_has_its_tool_at_its_end(made):
    arm = load_arm(made.chain("revolute", "revolute"))
    placement = arm.model.frames[arm.tool_frame_id].placement
    np.testing.assert_allclose(placement.translation, [0.4, 0.0, 0.02], atol=1e-12)


def test_what_the_limits_hold_is_not_what_the_elbow_holds(made):
    path = gripper(made, pads=True)
    here, elbow = load_arm(path), load_arm(path, tool_frame="link2")
    at_tool, at_elbow = (inspect_arm(arm, samples=50).payload for arm in (here, elbow))
    assert at_tool < 0.7 * at_elbow


def test_a_tool_at_a_joint_is_told(made):
    found = inspect_arm(load_arm(gripper(made), tool_frame="link2"), samples=5)
    assert "the tool frame link2 lies at the origin of joint2" in "\n".join(found.warnings)
    for arm in (load_arm(gripper(made)), load_arm("panda")):
        assert "lies at the origin" not in "\n".join(inspect_arm(arm, samples=5).warnings)


def test_a_written_file_keeps_the_placed_tool(made, tmp_path):
    arm = load_arm(gripper(made, pads=True))
    again = load_arm(arm.write_urdf(tmp_path / "again.urdf"))
    assert again.tool_frame == "tool_point"
    assert len(again.tree.links) == len(arm.tree.links)
    q = arm.random_configuration(np.random.default_rng(0))
    assert again.tool_pose(q).isApprox(arm.tool_pose(q), 1e-12)


def test_a_file_that_has_the_name_already(made):
    path = made.chain(
        "revolute",
        tail=[
            '<link name="tool_point"/>',
            made.joint("g", "base", "tool_point", "fixed", extra=""),
        ],
    )
    arm = load_arm(path)
    assert arm.tool_frame == "tool_point_2"


class TestPose:
    def test_it_is_the_tool_frame_in_the_world(self):
        arm = fp.load_arm("kinova")
        data = arm.model.createData()
        rng = np.random.default_rng(0)
        for _ in range(5):
            q = arm.random_configuration(rng)
            pin.forwardKinematics(arm.model, data, q)
            frame = arm.model.frames[arm.tool_frame_id]
            assert arm.tool_pose(q).isApprox(data.oMi[frame.parentJoint] * frame.placement, 1e-12)

    def test_of_the_two_link_arm_is_the_closed_form(self):
        arm = fp.load_arm("two_link")
        q = np.array([0.3, -0.7])
        ends = [arm.tool_pose([0.0, turn]).translation for turn in (0.0, np.pi)]
        assert np.linalg.norm(ends[0] - ends[1]) == pytest.approx(2 * 0.85)
        pose = arm.tool_pose(q)
        base = arm.tool_pose(np.zeros(2))
        assert np.linalg.norm(pose.translation - base.translation) > 0.1
        np.testing.assert_allclose(pose.rotation.T @ pose.rotation, np.eye(3), atol=1e-12)

    def test_poses_are_ones_own(self):
        arm = fp.load_arm("two_link")
        one = arm.tool_pose([0.0, 0.0])
        kept = one.translation.copy()
        arm.tool_pose([1.0, 1.0])
        np.testing.assert_array_equal(one.translation, kept)

    def test_a_bad_configuration_is_refused(self):
        with pytest.raises(fp.errors.ArgumentError, match="q"):
            fp.load_arm("two_link").tool_pose([0.0])
