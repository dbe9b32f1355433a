"""Friction of the arm's file, fed forward by a law that is told of it."""

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.control import FrictionTerms


def test_without_error_the_torque_is_inverse_dynamics_and_friction():
    plain = fp.load_arm("two_link")
    arm = fp.perturb(
        plain, friction=[2.0, 1.0], damping=[0.5, 0.3], stiction=1.5, stribeck_velocity=0.1
    )
    law = fp.ComputedTorque(arm, dt=1e-3)
    q, v, a = np.array([0.3, -0.5]), np.array([0.2, -0.05]), np.array([1.0, 2.0])
    without = law.update(q, v, q, v, a)
    law.reset()
    law.use_terms(FrictionTerms(arm))
    excess = arm.friction * 0.5 * np.exp(-((v / 0.1) ** 2))
    friction = arm.damping * v + (arm.friction + excess) * np.sign(v)
    assert np.allclose(law.update(q, v, q, v, a) - without, friction, rtol=1e-9)


def test_at_a_standstill_no_friction_is_asked_for():
    arm = fp.perturb(fp.load_arm("two_link"), friction=2.0)
    law = fp.ComputedTorque(arm, dt=1e-3)
    law.use_terms(FrictionTerms(arm))
    q, rest = np.array([0.3, -0.5]), np.zeros(2)
    assert np.allclose(law.update(q, rest, q, rest, rest), arm.gravity(q))
