"""The bounds of theory against closed forms and against the motions that they bound."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fotsmc_pin.analysis import obeys_power_condition, reaching_time_bound, settling_time_bound
from fotsmc_pin.errors import ArgumentError


def time_to_zero(rate_of, V, dt):
    """Time in which `dV/dt = -rate_of(V)` takes `V` to zero, by small steps."""
    t = 0.0
    while V > 0.0 and t < 100.0:
        V, t = V - dt * rate_of(V), t + dt
    return t


@pytest.mark.parametrize(("theta", "mu", "start"), [(5.0, 0.5, 2.0), (2.0, 0.8, 0.3)])
def test_44_is_the_time_that_its_reaching_law_takes(theta, mu, start):
    taken = time_to_zero(lambda V: theta * (V + V**mu), start, 1e-5)
    assert taken == pytest.approx(reaching_time_bound(start, theta, mu), rel=2e-3)


def test_44_takes_the_sum_of_magnitudes():
    assert reaching_time_bound([1.0, -2.0], 5.0, 0.5) == reaching_time_bound(3.0, 5.0, 0.5)


def test_44_of_the_papers_numbers_is_14_s_and_not_below_1_s():
    """`θ = 5`, `μ = 0.99`, and `S(0) = A e(0) + λ sig(e(0))^{0.9}` with `e(0) = (0.8, -0.5)`."""
    e = np.array([0.8, -0.5])
    S = 10.0 * e + 2.0 * np.sign(e) * np.abs(e) ** 0.9
    assert 13.5 < reaching_time_bound(S, 5.0, 0.99) < 14.5


@given(st.floats(0.0, 1e6), st.floats(1e-3, 1e3), st.floats(0.01, 0.99))
def test_44_falls_with_theta_and_rises_with_the_start(start, theta, mu):
    bound = reaching_time_bound(start, theta, mu)
    assert reaching_time_bound(start, 2.0 * theta, mu) == pytest.approx(bound / 2.0)
    assert reaching_time_bound(start + 1.0, theta, mu) >= bound >= 0.0


@pytest.mark.parametrize(("rate", "eta", "start"), [(2.0, 0.5, 4.0), (1.0, 0.3, 2.0)])
def test_lemma_1_is_the_time_that_its_inequality_takes(rate, eta, start):
    taken = time_to_zero(lambda V: rate * V**eta, start, 1e-5)
    assert taken == pytest.approx(settling_time_bound(start, rate, eta), rel=2e-3)


def test_lemma_1_with_one_half_is_37():
    assert settling_time_bound(3.0, 1.7) == pytest.approx(2.0 * math.sqrt(3.0) / 1.7)


@pytest.mark.parametrize(
    ("function", "arguments", "name"),
    [
        (reaching_time_bound, ([1.0, math.nan], 1.0, 0.5), "S_start"),
        (reaching_time_bound, (1.0, 0.0, 0.5), "theta"),
        (reaching_time_bound, (1.0, 1.0, 1.0), "mu"),
        (settling_time_bound, (-1.0, 1.0), "V_start"),
        (settling_time_bound, (1.0, 0.0), "rate"),
        (settling_time_bound, (1.0, 1.0, 1.0), "eta"),
    ],
)
def test_bad_arguments_are_named(function, arguments, name):
    with pytest.raises(ArgumentError) as caught:
        function(*arguments)
    assert caught.value.argument == name


@pytest.mark.parametrize(
    ("power", "obeyed"), [(0.9, False), (1.0, False), (1.1, True), (5 / 3, True), (2.0, False)]
)
def test_the_condition_on_p_over_q_is_open_at_both_ends(power, obeyed):
    assert obeys_power_condition(power) == obeyed
