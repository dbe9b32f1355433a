"""Velocity from position: how late, how exact, how noisy, and on joints that turn on and on."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import ExactDifferentiator, FilteredDifferentiator
from fotsmc_pin.errors import ArgumentError

DT = 1e-3


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


def followed(differentiator, arm, position, duration=2.0, noise=0.0):
    """Velocities (N, 2) at times (N,) of joints that follow `position(t)`."""
    rng = np.random.default_rng(0)
    times = np.arange(0.0, duration, DT)
    velocities = []
    for t in times:
        measured = position(t) + noise * rng.standard_normal(2)
        velocities.append(differentiator.update(measured))
    return times, np.array(velocities)


@pytest.mark.parametrize("bandwidth", [50.0, 300.0])
def test_the_filter_is_as_late_as_it_says(arm, bandwidth):
    differentiator = FilteredDifferentiator(arm, DT, bandwidth=bandwidth)
    t, v = followed(differentiator, arm, lambda t: np.array([0.5 * t**2, t]))
    assert v[-1, 0] == pytest.approx(t[-1] - differentiator.delay, abs=1e-9)
    assert v[-1, 1] == pytest.approx(1.0, abs=1e-9)


def test_the_exact_differentiator_is_not_late(arm):
    differentiator = ExactDifferentiator(arm, DT, jerk=100.0)
    t, v = followed(differentiator, arm, lambda t: np.array([np.sin(3.0 * t), 0.5 * t**2]))
    late = t > 0.5
    error = v - np.stack([3.0 * np.cos(3.0 * t), t], axis=1)
    # Of the order jerk dt² = 1e-4; a filter of 300 rad/s would err by 9 rad/s² · 3.8 ms = 35e-3.
    assert np.abs(error[late]).max() < 2e-3


def test_with_noise_the_error_is_of_the_stated_order(arm):
    noise, jerk = 1e-5, 100.0
    differentiator = ExactDifferentiator(arm, DT, jerk=jerk)
    t, v = followed(differentiator, arm, lambda t: np.sin(3.0 * t) * np.ones(2), noise=noise)
    error = v[t > 0.5] - 3.0 * np.cos(3.0 * t[t > 0.5])[:, None]
    order = jerk ** (1 / 3) * noise ** (2 / 3)
    assert 0.1 * order < np.sqrt(np.mean(error**2)) < 10.0 * order


@pytest.mark.parametrize("kind", [FilteredDifferentiator, ExactDifferentiator])
class TestBoth:
    def test_a_continuous_joint_may_turn_on_and_on(self, kind):
        kinova = fp.load_arm("kinova")
        differentiator = kind(kinova, DT)
        for t in np.arange(0.0, 5.0, DT):
            v = differentiator.update(kinova.from_joint_positions(np.full(6, 2.0 * t)))
        np.testing.assert_allclose(v, 2.0, atol=0.1)

    def test_reset_forgets(self, kind, arm):
        used, fresh = kind(arm, DT), kind(arm, DT)
        for k in range(20):
            used.update([0.01 * k, 0.0])
        used.reset()
        for k in range(20):
            q = [1.0 + 0.001 * k**2, -1.0]
            np.testing.assert_array_equal(used.update(q), fresh.update(q))

    def test_it_goes_by_the_measured_period(self, kind, arm):
        differentiator = kind(arm, DT)
        rng, t = np.random.default_rng(1), 0.0
        for _ in range(3000):
            dt = DT * rng.uniform(0.7, 1.3)
            t += dt
            v = differentiator.update([0.8 * t, -0.3 * t], dt)
        np.testing.assert_allclose(v, [0.8, -0.3], atol=0.15)

    def test_bad_numbers_are_refused(self, kind, arm):
        with pytest.raises(ArgumentError, match="dt"):
            kind(arm, 0.0)
        with pytest.raises(ArgumentError, match="q"):
            differentiator = kind(arm, DT)
            differentiator.update([0.0, 0.0])
            differentiator.update([np.nan, 0.0])
