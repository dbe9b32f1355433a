"""`Hold`, `Sinusoid` and `broken_limits`."""

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.arms.catalog import EXAMPLE_ROBOTS
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold, Sinusoid, broken_limits

ARMS = ["two_link", *EXAMPLE_ROBOTS]


@pytest.mark.parametrize("name", ["panda", "kinova"])
def test_hold_holds(name):
    arm = load_arm(name)
    hold = Hold(arm)
    q, v, a = hold(3.0)
    np.testing.assert_array_equal(q, arm.neutral)
    assert not v.any()
    assert not a.any()
    q[:] = 9.0
    np.testing.assert_array_equal(hold(4.0)[0], arm.neutral)


@pytest.mark.parametrize("name", ARMS)
def test_sinusoids_start_at_rest_and_keep_every_limit(name):
    arm = load_arm(name)
    reference = Sinusoid.inside_limits(arm)
    q, v, a = reference(0.0)
    np.testing.assert_allclose(arm.difference(reference.center, q), 0.0, atol=1e-12)
    assert not v.any()
    assert not a.any()
    assert reference.amplitude.min() > 0.05
    assert broken_limits(arm, reference, duration=12.0, effort_share=0.55) == ()


@pytest.mark.parametrize("name", ["panda", "kinova"])
@pytest.mark.parametrize("ramp", [0.0, 2.0])
def test_derivatives_of_sinusoids(name, ramp, assert_exact_derivatives):
    arm = load_arm(name)
    reference = Sinusoid.inside_limits(arm, ramp=ramp)
    assert_exact_derivatives(arm, reference, [0.3, 1.1, 1.9999, 2.0001, 3.7])


def test_a_center_is_kept():
    arm = load_arm("panda")
    center = arm.neutral + 0.1
    np.testing.assert_allclose(Sinusoid.inside_limits(arm, center=center).center, center)


def test_an_arm_too_weak_to_hold_itself_is_told():
    arm = load_arm("panda", effort_limit=1.0)
    with pytest.raises(ArgumentError, match=r"panda_joint\d: effort"):
        Sinusoid.inside_limits(arm)


def test_broken_limits_name_joint_time_and_limit():
    arm = load_arm("panda")
    reference = Sinusoid(arm=arm, center=arm.neutral, amplitude=np.full(7, 2.0), period=0.5)
    sentences = broken_limits(arm, reference, duration=3.0)
    for what in ("position", "velocity", "effort"):
        assert any(what in sentence for sentence in sentences)
    assert any(sentence.startswith("panda_joint4: position") for sentence in sentences)


def test_an_endless_reference_needs_a_duration():
    arm = load_arm("two_link")
    with pytest.raises(ArgumentError, match="duration"):
        broken_limits(arm, Hold(arm))


@pytest.mark.parametrize(
    "option", [{"amplitude": -1.0}, {"period": 0.0}, {"fraction": 1.5}, {"center": [0.0]}]
)
def test_bad_numbers_are_named(option):
    with pytest.raises(ArgumentError, match=next(iter(option))):
        Sinusoid.inside_limits(load_arm("two_link"), **option)
