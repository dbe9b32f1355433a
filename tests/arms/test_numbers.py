"""Limits, friction and armature: what the file says, and whose numbers count."""

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.errors import ArgumentError

NUMBERS = (
    "armature",
    "friction",
    "damping",
    "effort_limit",
    "velocity_limit",
    "upper_position_limit",
)


@pytest.mark.parametrize("what", NUMBERS)
@pytest.mark.parametrize(
    ("given", "expected"),
    [(1.5, [1.5, 1.5]), ([1.0, 2.0], [1.0, 2.0]), ({"joint1": 1.5, "*2": 2.5}, [1.5, 2.5])],
)
def test_overrides(what, given, expected):
    arm = load_arm("two_link", **{what: given})
    np.testing.assert_array_equal(getattr(arm, what), expected)


def test_a_mapping_leaves_the_other_joints_alone():
    arm = load_arm("two_link", armature={"joint2": 1.0})
    np.testing.assert_array_equal(arm.armature, [5.0, 1.0])


@pytest.mark.parametrize("what", NUMBERS)
@pytest.mark.parametrize(
    "given", [[1.0], [1.0, 2.0, 3.0], {"elbow": 1.0}, "strong", np.nan, {"joint1": "x"}]
)
def test_a_bad_override_is_refused(what, given):
    with pytest.raises(ArgumentError, match=what):
        load_arm("two_link", **{what: given})


@pytest.mark.parametrize("given", [{"armature": -1.0}, {"effort_limit": 0.0}, {"friction": np.inf}])
def test_a_number_that_no_joint_has_is_refused(given):
    with pytest.raises(ArgumentError, match=next(iter(given))):
        load_arm("two_link", **given)


def test_both_position_limits_may_move_past_the_old_ones():
    arm = load_arm("panda", lower_position_limit=5.0, upper_position_limit=6.0)
    np.testing.assert_array_equal(arm.lower_position_limit, np.full(7, 5.0))
    with pytest.raises(ArgumentError, match="not below"):
        load_arm("panda", lower_position_limit=5.0)


def test_limits_can_be_lifted_and_travel_so(made):
    arm = load_arm("panda", effort_limit=np.inf, upper_position_limit={"panda_joint1": np.inf})
    again = load_arm(arm.write_urdf(made.folder / "free.urdf"))
    assert np.isinf(again.effort_limit).all()
    assert np.isinf(again.upper_position_limit[0])
    np.testing.assert_array_equal(again.lower_position_limit, arm.lower_position_limit)


@pytest.mark.parametrize("number", ["0", "inf", "INF", "Infinity"])
def test_zero_and_infinity_mean_not_given(made, number):
    limit = f'<limit effort="{number}" velocity="{number}"/>'
    arm = load_arm(made.chain("revolute", "prismatic", extra=limit))
    assert np.isinf(arm.effort_limit).all()
    assert np.isinf(arm.velocity_limit).all()
    assert np.isinf(arm.lower_position_limit).all()


def test_infinite_position_limits_are_read(made):
    limit = '<limit lower="-inf" upper="1" effort="1" velocity="1"/>'
    arm = load_arm(made.chain("revolute", extra=limit))
    assert (arm.lower_position_limit[0], arm.upper_position_limit[0]) == (-np.inf, 1.0)


def test_a_joint_without_limits_loads_and_is_noted(made):
    arm = load_arm(made.chain("revolute", extra=""))
    assert np.isinf(arm.effort_limit).all()
    assert any("joint1 gives no effort or velocity limit" in note for note in arm.notes)


def test_armature_comes_from_drakes_tags_declared_or_not(made):
    transmission = (
        '<transmission name="t"><joint name="joint1"/><actuator name="m">'
        '<drake:rotor_inertia value="1e-4"/><drake:gear_ratio value="100"/>'
        "</actuator></transmission>"
    )
    arm = load_arm(made.chain("revolute", "revolute", tail=(transmission,)))
    np.testing.assert_allclose(arm.armature, [1.0, 0.0])


def test_locking_a_joint_takes_its_motor_and_no_other(made):
    tail = (
        '<transmission name="t"><joint name="joint1"/><joint name="joint2"/><actuator name="m">'
        '<drake:rotor_inertia value="0.5"/></actuator></transmission>'
        '<transmission name="u"><joint name="joint3"/></transmission>',
    )
    path = made.chain("revolute", "revolute", "revolute", tail=tail)
    arm = load_arm(path, lock=["joint2", "joint3"])
    np.testing.assert_array_equal(arm.armature, [0.5])
    assert arm.urdf.count("<transmission") == 1


def test_friction_and_damping_come_from_the_file():
    arm = load_arm("xarm7")
    np.testing.assert_array_equal(arm.friction, np.ones(7))
    np.testing.assert_array_equal(arm.damping, [10, 10, 5, 5, 5, 2, 2])
