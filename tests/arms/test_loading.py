"""`load_arm`: where arms come from, which joints stay free, and whose numbers count."""

import json
import sys
import time

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm, perturb
from fotsmc_pin.errors import ArgumentError, ArmNotFoundError


def test_a_path_wins_over_names(made, monkeypatch):
    monkeypatch.chdir(made.chain("revolute").rename(made.folder / "panda").parent)
    assert load_arm("panda").nv == 1


@pytest.mark.parametrize("source", ["gone.urdf", "no/such/folder/arm.urdf", "./panda"])
def test_a_missing_file_is_said_to_be_missing(source):
    with pytest.raises(ArmNotFoundError, match="does not exist"):
        load_arm(source)


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(ArmNotFoundError, match="is a folder"):
        load_arm(tmp_path)


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(ArmNotFoundError, match=r"'pandda'.*two_link.*panda"):
        load_arm("pandda")


def test_other_files_of_example_robot_data_go_by_their_stem():
    assert load_arm("ur5_gripper").nv == 6


def test_robot_descriptions(made, monkeypatch):
    path = made.chain("revolute", "revolute")
    package = made.folder / "robot_descriptions"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "gizmo_description.py").write_text(
        f"URDF_PATH = {str(path)!r}\nPACKAGE_PATH = {str(made.folder)!r}\n"
    )
    monkeypatch.syspath_prepend(made.folder)
    for name in [name for name in sys.modules if name.startswith("robot_descriptions")]:
        monkeypatch.delitem(sys.modules, name)
    arm = load_arm("gizmo")
    for name in ("robot_descriptions", "robot_descriptions.gizmo_description"):
        monkeypatch.delitem(sys.modules, name)
    assert (arm.name, arm.nv) == ("gizmo", 2)


def test_grippers_and_mimic_joints_are_locked_and_said_so():
    panda = load_arm("panda")
    assert panda.joint_names == tuple(f"panda_joint{number}" for number in range(1, 8))
    assert "locked panda_finger_joint1 at 0 m (gripper)" in panda.notes
    assert "locked panda_finger_joint2 at 0 m (mimic joint)" in panda.notes
    assert load_arm("z1").nv == 6


def test_a_finger_of_its_own_is_an_arm():
    assert load_arm("finger_edu").nv == 3


def test_keep_leaves_only_what_it_names():
    left = load_arm("baxter", keep="left_*")
    assert left.nv == 7
    assert all(name.startswith("left_") for name in left.joint_names)
    assert left.tool_frame == "left_gripper"
    assert load_arm("panda", keep=["panda_joint?", "panda_finger_joint1"]).nv == 8


def test_lock_takes_from_what_keep_leaves():
    arm = load_arm("baxter", keep="left_*", lock=["left_w?"])
    assert arm.joint_names == ("left_s0", "left_s1", "left_e0", "left_e1")


def test_a_locked_joint_stays_where_it_is_put(made):
    """An arm with its wrist locked moves as the whole arm does with its wrist held there."""
    path = made.chain("revolute", "prismatic", "continuous", "revolute")
    whole = load_arm(path)
    locked = load_arm(path, lock={"joint2": 0.3, "joint3": -2.0})
    assert locked.joint_names == ("joint1", "joint4")
    q = np.array([0.4, -0.7])
    q_whole = whole.from_joint_positions([0.4, 0.3, -2.0, -0.7])
    np.testing.assert_allclose(locked.gravity(q), whole.gravity(q_whole)[[0, 3]], atol=1e-12)
    mass = whole.mass_matrix(q_whole)[np.ix_([0, 3], [0, 3])]
    np.testing.assert_allclose(locked.mass_matrix(q), mass, atol=1e-12)


def test_a_locked_mimic_joint_follows_its_leader(made):
    follower = made.joint(
        "thumb", "link1", "tip", extra='<mimic joint="joint1" multiplier="-2" offset="0.1"/>'
    )
    path = made.chain("revolute", "revolute", tail=(made.link("tip"), follower))
    assert "locked thumb at -0.7 rad (mimic joint)" in load_arm(path, lock={"joint1": 0.4}).notes


def test_a_joint_locked_without_a_place_goes_to_the_nearest_limit(made):
    limit = '<limit lower="0.5" upper="1" effort="1" velocity="1"/>'
    arm = load_arm(made.chain("revolute", "revolute", extra=limit), lock="joint2")
    assert "locked joint2 at 0.5 rad (as asked)" in arm.notes


@pytest.mark.parametrize("option", ["lock", "keep"])
def test_an_unknown_joint_is_refused(option):
    with pytest.raises(ArgumentError, match=r"elbow.*panda_joint1"):
        load_arm("panda", **{option: ["elbow*"]})


@pytest.mark.parametrize("option", ["lock", "keep"])
@pytest.mark.parametrize("value", [3, [1, 2]])
def test_joints_are_named_by_text(option, value):
    with pytest.raises(ArgumentError, match="as text"):
        load_arm("panda", **{option: value})


def test_locking_everything_leaves_no_arm():
    with pytest.raises(ValueError, match="no joint moves"):
        load_arm("two_link", lock="*")


def test_tool_frames():
    expected = {"panda": "panda_hand_tcp", "ur5": "tool0", "kinova": "j2s6s200_end_effector"}
    assert {name: load_arm(name).tool_frame for name in expected} == expected
    assert load_arm("z1").tool_frame_id > 0
    with pytest.raises(ArgumentError, match="tool_frame"):
        load_arm("panda", tool_frame="nose")


def test_everything_about_an_arm_fits_into_json():
    parts = load_arm("panda", lock={"panda_joint3": 0.5}).to_dict()
    assert json.loads(json.dumps(parts)) == parts


def test_comments_and_unknown_tags_survive(made):
    tail = ("<!-- calibrated -->", '<gazebo reference="link1"><kp>10</kp></gazebo>', "<ros:x/>")
    text = load_arm(made.chain("revolute", tail=tail)).urdf
    for part in ("<!-- calibrated -->", "<kp>10</kp>", "<ros:x"):
        assert part in text


def test_a_licence_above_the_root_survives_perturbing(made):
    path = made.chain("revolute")
    path.write_text("<!-- Licence: be kind -->" + path.read_text())
    text = perturb(perturb(load_arm(path), mass_scale=1.1), payload=1.0).urdf
    assert text.count("Licence: be kind") == 1
    assert text.count("Changes to") == 1


def test_loading_takes_under_50_ms():
    """Of the processor's time, so that a busy machine does not count."""
    load_arm("panda")
    times = []
    for _ in range(5):
        start = time.process_time()
        load_arm("panda")
        times.append(time.process_time() - start)
    assert min(times) < 0.05
