"""Laws of fractional calculus, for signals and orders that nobody chose."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral

kinds = st.sampled_from([FractionalDerivative, FractionalIntegral])
schemes = st.sampled_from(["linear", "quadratic", "grunwald-letnikov"])
orders = st.sampled_from([0.0, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0])
temperings = st.sampled_from([0.0, 3.0])
seeds = st.integers(0, 2**32 - 1)
few = settings(max_examples=25, deadline=None)

DT = 1e-2


def walk(seed, count=120, n=1):
    """A random walk that starts at 0."""
    steps = np.random.default_rng(seed).normal(size=(count, n))
    steps[0] = 0.0
    return np.cumsum(steps, axis=0)


def periods(seed, count=120):
    return DT * np.random.default_rng(seed).uniform(0.7, 1.3, count)


def run(kind, x, clock=None, dt=DT, **description):
    return kind(dt=dt, **description).stream(x.shape[1]).update_many(x, clock)


def smooth(seed, t):
    """A random sum of `sin² ωt`: value and slope are 0 at the start."""
    rng = np.random.default_rng(seed)
    waves = np.sin(np.outer(t, rng.uniform(0.3, 2.0, 4))) ** 2
    return (waves @ rng.normal(size=4))[:, None]


@few
@given(kinds, schemes, orders, temperings, seeds, st.floats(-10, 10))
def test_linearity(kind, scheme, order, tempering, seed, factor):
    x, y, dt = walk(seed), walk(seed + 1) + 1.0, periods(seed)
    described = {"order": order, "scheme": scheme, "tempering": tempering}
    both = run(kind, x + factor * y, dt, **described)
    sum_of_both = run(kind, x, dt, **described) + factor * run(kind, y, dt, **described)
    np.testing.assert_allclose(both, sum_of_both, atol=1e-9 * (1 + np.abs(both).max()))


@few
@given(kinds, schemes, orders, temperings, seeds)
def test_streaming_is_batch(kind, scheme, order, tempering, seed):
    x, dt = walk(seed, n=2), periods(seed)
    operator = kind(order=order, dt=DT, scheme=scheme, tempering=tempering)
    batch, stream = operator.stream(2).update_many(x, dt), operator.stream(2)
    for row, period, expected in zip(x, dt, batch, strict=True):
        np.testing.assert_array_equal(stream.update(row, period), expected)


@few
@given(kinds, schemes, orders, seeds, st.sampled_from([0.25, 0.5, 2.0, 8.0]))
def test_scaling_in_time(kind, scheme, order, seed, scale):
    """`D^α[x(ct)] = c^α (D^α x)(ct)`."""
    x, dt = walk(seed), periods(seed)
    signed = order if kind is FractionalDerivative else -order
    here = run(kind, x, dt, order=order, scheme=scheme)
    there = run(kind, x, scale * dt, order=order, scheme=scheme, dt=scale * DT)
    expected = here * scale**-signed
    np.testing.assert_allclose(there, expected, atol=1e-7 * np.abs(expected).max())


@few
@given(st.sampled_from(["linear", "quadratic"]), st.sampled_from([0.2, 0.4]), temperings, seeds)
def test_semigroup_of_integrals(scheme, order, tempering, seed):
    x = smooth(seed, np.arange(400) * DT)
    described = {"scheme": scheme, "tempering": tempering}
    twice = run(
        FractionalIntegral,
        run(FractionalIntegral, x, order=order, **described),
        order=0.5,
        **described,
    )
    once = run(FractionalIntegral, x, order=order + 0.5, **described)
    np.testing.assert_allclose(twice, once, atol=2e-3 * np.abs(once).max())


@few
@given(schemes, st.sampled_from([0.1, 0.5, 0.9]), temperings, seeds)
def test_the_derivative_undoes_the_integral(scheme, order, tempering, seed):
    x = smooth(seed, np.arange(400) * DT)
    described = {"order": order, "scheme": scheme, "tempering": tempering}
    back = run(FractionalDerivative, run(FractionalIntegral, x, **described), **described)
    tolerance = 1e-6 if scheme == "grunwald-letnikov" else 2e-2
    np.testing.assert_allclose(back, x, atol=tolerance * np.abs(x).max())


@few
@given(kinds, schemes, temperings, seeds)
def test_order_to_zero_is_the_identity(kind, scheme, tempering, seed):
    x, dt = walk(seed), periods(seed)
    described = {"scheme": scheme, "tempering": tempering}
    np.testing.assert_array_equal(run(kind, x, dt, order=0.0, **described), x)
    near = run(kind, x, dt, order=1e-3, tolerance=1e-6, **described)
    np.testing.assert_allclose(near, x, atol=1e-2 * np.abs(x).max())


@few
@given(kinds, schemes, temperings, seeds)
def test_order_to_one_is_integer_calculus(kind, scheme, tempering, seed):
    x, dt = walk(seed), periods(seed)
    described = {"scheme": scheme, "tempering": tempering}
    one = run(kind, x, dt, order=1.0, **described)
    near = run(kind, x, dt, order=0.999, tolerance=1e-6, **described)
    np.testing.assert_allclose(near, one, atol=1e-2 * np.abs(one).max())


@few
@given(seeds)
def test_order_one_is_trapezoid_and_backward_difference(seed):
    x, dt = walk(seed), periods(seed)
    trapezoid = np.cumsum(0.5 * (x[1:] + x[:-1]) * dt[1:, None], axis=0)
    np.testing.assert_allclose(run(FractionalIntegral, x, dt, order=1.0)[1:], trapezoid, atol=1e-10)
    difference = np.diff(x, axis=0) / dt[1:, None]
    np.testing.assert_allclose(
        run(FractionalDerivative, x, dt, order=1.0)[1:], difference, atol=1e-9
    )


@pytest.mark.parametrize("order", [0.1, 0.5, 0.9])
def test_the_linear_scheme_amplifies_noise_less(order):
    noise = np.random.default_rng(0).normal(size=(5000, 1))
    spread = [
        run(FractionalDerivative, noise, order=order, scheme=scheme).std()
        for scheme in ("linear", "quadratic")
    ]
    assert spread[0] < spread[1]
