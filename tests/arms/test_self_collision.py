"""Distances between the links of an arm: their gradient, what is looked at, and a floor."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms.self_collision import SelfCollision


@pytest.fixture(scope="module")
def panda():
    return fp.load_arm("panda")


def test_the_gradient_is_the_slope_of_the_distance(panda):
    collision, rng = SelfCollision(panda), np.random.default_rng(1)
    looked = 0
    for _ in range(10):
        q = panda.random_configuration(rng)
        distances = collision.prepare_gradients(q)
        for pair in np.flatnonzero((distances > 0.01) & (distances < 0.2))[:3]:
            collision.prepare_gradients(q)
            slope, turn = collision.gradient(int(pair)), rng.standard_normal(panda.nv)
            ahead = collision.distances(panda.integrate(q, 1e-3 * turn))[pair]
            behind = collision.distances(panda.integrate(q, -1e-3 * turn))[pair]
            assert (ahead - behind) / 2e-3 == pytest.approx(slope @ turn, abs=0.02)
            looked += 1
    assert looked > 5


def test_hulls_are_never_farther_than_the_shapes(panda):
    collision, rng = SelfCollision(panda, clearance=0.02), np.random.default_rng(2)
    found = [q for _ in range(60) if collision.collides(q := panda.random_configuration(rng))]
    assert found
    assert all((collision.distances(q) < collision.clearances).any() for q in found)


def test_links_that_touch_at_neutral_and_hardly_elsewhere_are_a_collision(panda):
    collision = SelfCollision(panda)
    assert collision.left_out == ()
    assert collision.collides(panda.neutral)  # The fifth link touches the hand there.


def test_links_that_always_touch_or_are_near_by_design_do_not_forbid_everything():
    talos, finger = (SelfCollision(fp.load_arm(name)) for name in ("talos_arm", "finger_edu"))
    assert len(talos.left_out) == 1
    assert (finger.clearances == 0.0).sum() == 1
    assert not finger.collides(finger.arm.neutral)


def test_a_floor_is_hit_from_above_only():
    arm = fp.load_arm("ur5")
    reach = arm.from_joint_positions([0.0, 0.6, 0.0, 0.0, 0.0, 0.0])  # Below the horizontal.
    assert not SelfCollision(arm).collides(reach)
    assert SelfCollision(arm, floor=0.0).collides(reach)
    assert not SelfCollision(arm, floor=-2.0).collides(reach)


def test_an_arm_without_shapes_never_collides():
    arm = fp.load_arm("two_link")
    assert not SelfCollision(arm).collides(arm.neutral)
    assert SelfCollision(arm).pairs == ()
