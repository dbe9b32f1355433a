"""`Arm`: its terms obey the equation of motion, its configurations the joints' geometry."""

import pickle

import numpy as np
import pytest

from fotsmc_pin.arms import Arm, load_arm
from fotsmc_pin.arms.catalog import EXAMPLE_ROBOTS
from fotsmc_pin.errors import ArgumentError


@pytest.mark.parametrize("name", [*EXAMPLE_ROBOTS, "two_link"])
def test_terms_add_up_to_inverse_dynamics(name):
    arm, rng = load_arm(name, armature=0.1), np.random.default_rng(2)
    for _ in range(20):
        q = arm.random_configuration(rng)
        v, a = rng.normal(size=arm.nv), rng.normal(size=arm.nv)
        mass = arm.mass_matrix(q)
        tau = arm.inverse_dynamics(q, v, a)
        terms = mass @ a + arm.coriolis(q, v) @ v + arm.gravity(q)
        np.testing.assert_allclose(terms, tau, rtol=0, atol=1e-12 * max(1.0, abs(tau).max()))
        np.testing.assert_allclose(mass, mass.T, atol=1e-14)
        assert np.linalg.eigvalsh(mass)[0] > 0.0
        back = arm.forward_dynamics(q, v, tau)
        np.testing.assert_allclose(back, a, atol=1e-7)


@pytest.mark.parametrize("name", ["panda", "kinova", "baxter", "double_pendulum_continuous"])
def test_random_configurations_stay_inside_the_limits(name):
    arm, rng = load_arm(name), np.random.default_rng(3)
    for q in (arm.neutral, *(arm.random_configuration(rng) for _ in range(100))):
        x = arm.to_joint_positions(q)
        assert np.all(x >= arm.lower_position_limit - 1e-12)
        assert np.all(x <= arm.upper_position_limit + 1e-12)


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_difference_undoes_integrate(name):
    arm, rng = load_arm(name), np.random.default_rng(4)
    for _ in range(50):
        q, step = arm.random_configuration(rng), rng.uniform(-1, 1, arm.nv)
        np.testing.assert_allclose(arm.difference(q, arm.integrate(q, step)), step, atol=1e-12)


def test_the_error_of_plain_joints_is_the_difference(made):
    arm = load_arm(made.chain("revolute", "prismatic"))
    assert arm.is_euclidean
    q, q_d = np.array([0.5, 0.2]), np.array([0.1, 0.4])
    np.testing.assert_allclose(arm.difference(q_d, q), q - q_d)


def test_units_follow_the_joints(made):
    arm = load_arm(made.chain("revolute", "prismatic", "continuous"))
    assert (arm.nq, arm.nv) == (4, 3)
    assert not arm.is_euclidean
    assert arm.position_units == ("rad", "m", "rad")
    assert arm.effort_units == ("N·m", "N", "N·m")


def test_a_prismatic_joint_lifts_against_gravity(made):
    """A vertical slide carries the weight of what is on it."""
    slide = made.joint("lift", "base", "carriage", "prismatic", axis="0 0 1").replace(
        'rpy="0.1 0.2 0.3"', ""
    )
    arm = load_arm(made.file(made.link("carriage", mass=3.0), slide))
    np.testing.assert_allclose(arm.gravity([0.1]), [3.0 * 9.81])


@pytest.mark.parametrize("name", ["two_link_true", "kinova"])
def test_an_arm_travels_as_text(name):
    arm = load_arm(name, lock=None, armature=0.2, friction=0.1)
    for copy in (Arm.from_dict(arm.to_dict()), pickle.loads(pickle.dumps(arm))):
        assert copy == arm
        q = arm.random_configuration(np.random.default_rng(5))
        np.testing.assert_array_equal(copy.mass_matrix(q), arm.mass_matrix(q))
        np.testing.assert_array_equal(copy.friction, arm.friction)
    assert len(pickle.dumps(arm)) < 60_000


def test_an_arm_does_not_change():
    arm = load_arm("two_link")
    with pytest.raises(AttributeError):
        arm.name = "other"
    with pytest.raises(ValueError, match="read-only"):
        arm.effort_limit[0] = 1.0
    mass = arm.mass_matrix([0.0, 0.0])
    mass[:] = 0.0
    assert arm.mass_matrix([0.0, 0.0])[0, 0] > 1.0


@pytest.mark.parametrize("q", [[0.0], [0.0, np.nan], [0.0, 0.0, 0.0], "ab"])
def test_a_bad_configuration_is_named(q):
    with pytest.raises(ArgumentError, match=r"^q = "):
        load_arm("two_link").gravity(q)
