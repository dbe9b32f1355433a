"""The sums of exponentials keep what their certificates say."""

import math
import time

import numpy as np
import pytest

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional import FractionalDerivative, power_law_sum
from fotsmc_pin.fractional.grunwald_letnikov import integral_weights, weight_sum

EXPONENTS = (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10, 1e-11])
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_power_law_is_kept_between_the_samples_of_the_certificate(exponent, tolerance):
    found = power_law_sum(exponent, 1e-4, 1e3, tolerance)
    t = np.geomspace(1e-4, 1e3, 3001)
    error = np.abs(found(t) * t**exponent * math.gamma(1 - exponent) - 1)
    assert found.certificate <= tolerance
    assert error.max() <= 1.01 * found.certificate
    assert (found.weights > 0).all()
    assert (found.rates >= 0).all()


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_at_most_sixty_modes_over_seven_decades(exponent):
    assert power_law_sum(exponent, 1e-4, 1e3, 1e-8).modes <= 60


def test_built_in_under_50_ms_and_kept():
    durations = []
    for i in range(5):
        start = time.perf_counter()
        power_law_sum(0.37 + i * 1e-6, 1e-4, 1e3, 1e-8)
        durations.append(time.perf_counter() - start)
    assert min(durations) < 0.05
    assert power_law_sum(0.37, 1e-4, 1e3, 1e-8) is power_law_sum(0.37, 1e-4, 1e3, 1e-8)


def test_what_cannot_be_reached_names_a_horizon_that_can():
    with pytest.raises(ArgumentError, match="horizon") as caught:
        power_law_sum(0.9, 1e-6, 1e12, 1e-11)
    within = float(caught.value.remedy.split("at most ")[1].split(" s")[0])
    assert power_law_sum(0.9, 1e-6, within, 1e-11).certificate <= 1e-11


@pytest.mark.parametrize("differences", [False, True])
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_every_grunwald_letnikov_weight_over_a_million_samples(exponent, differences):
    found = weight_sum(exponent, differences, 10**6, 1e-8)
    assert found.modes <= 60
    assert found.certificate <= 1e-8
    ages = np.arange(1, 10**6 + 1)
    exact = np.cumprod(1 - exponent / ages)
    some = np.unique(np.append(np.arange(1, 3000), np.arange(1, 10**6, 211)))
    powers = np.exp(-np.outer(some + 1.0, np.log1p(found.rates)))
    if differences:
        values = -powers @ (found.weights * found.rates)
        values[0] = powers[0] @ found.weights - 1
        exact = exact * -exponent / (ages - exponent)
    else:
        values = powers @ found.weights
    assert np.max(np.abs(values / exact[some - 1] - 1)) < 1.01e-8


def test_closed_form_of_the_weights_is_the_product():
    ages = np.arange(0.0, 20001.0)
    product = np.cumprod(np.append(1.0, 1 - 0.3 / ages[1:]))
    np.testing.assert_allclose(integral_weights(0.3, ages), product, rtol=1e-12)


@pytest.mark.parametrize("scheme", ["linear", "quadratic", "grunwald-letnikov"])
def test_repr_shows_the_certificate(scheme):
    operator = FractionalDerivative(order=0.4, dt=1e-3, scheme=scheme)
    assert 0 < operator.certificate <= operator.tolerance
    assert f"{operator.certificate:.2g}" in repr(operator)
    assert f"{operator.certificate:.2g}" in repr(operator.exponential_sum)


@pytest.mark.parametrize("differences", [False, True])
@pytest.mark.parametrize("exponent", [0.01, 0.02, 0.05, 0.1, 0.3, 0.9])
def test_weights_that_cannot_be_reached_name_a_tolerance_that_can(exponent, differences):
    try:
        found = weight_sum(exponent, differences, 10**6, 1e-11)
    except ArgumentError as refused:
        tolerance = float(refused.remedy.split("at least ")[1])
        assert tolerance <= 5e-8
        found = weight_sum(exponent, differences, 10**6, tolerance)
    assert found.certificate <= found.tolerance
