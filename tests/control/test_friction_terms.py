"""Friction of the arm's file, fed forward by the laws of an arm whose friction is known."""

import copy

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import with_known_friction
from fotsmc_pin.errors import UrdfError


def test_without_error_the_torque_is_inverse_dynamics_and_friction():
    plain = fp.load_arm("two_link")
    arm = fp.perturb(
        plain, friction=[2.0, 1.0], damping=[0.5, 0.3], stiction=1.5, stribeck_velocity=0.1
    )
    q, v, a = np.array([0.3, -0.5]), np.array([0.2, -0.05]), np.array([1.0, 2.0])
    without = fp.ComputedTorque(arm, dt=1e-3).update(q, v, q, v, a)
    law = copy.copy(fp.ComputedTorque(with_known_friction(arm), dt=1e-3))
    excess = arm.friction * 0.5 * np.exp(-((v / 0.1) ** 2))
    friction = arm.damping * v + (arm.friction + excess) * np.sign(v)
    assert np.allclose(law.update(q, v, q, v, a) - without, friction, rtol=1e-9)


def test_at_a_standstill_no_friction_is_asked_for():
    arm = with_known_friction(fp.perturb(fp.load_arm("two_link"), friction=2.0))
    law = fp.ComputedTorque(arm, dt=1e-3)
    q, rest = np.array([0.3, -0.5]), np.zeros(2)
    assert np.allclose(law.update(q, rest, q, rest, rest), arm.gravity(q))


def test_the_word_goes_with_the_file(tmp_path):
    arm = fp.perturb(fp.load_arm("two_link", gravity=(0.0, 0.0, -1.62)), friction=2.0)
    known = with_known_friction(arm)
    assert known.friction_is_known
    assert not arm.friction_is_known
    assert known.base_gravity[2] == arm.base_gravity[2]
    read = fp.load_arm(known.write_urdf(tmp_path / "known.urdf"))
    assert read.friction_is_known
    assert fp.perturb(read, payload=1.0).friction_is_known


def test_another_word_is_refused(tmp_path):
    file = with_known_friction(fp.load_arm("two_link")).write_urdf(tmp_path / "arm.urdf")
    file.write_text(
        file.read_text("utf-8").replace('friction="known"', 'friction="maybe"'), "utf-8"
    )
    with pytest.raises(UrdfError, match='write friction="known"'):
        fp.load_arm(file)
