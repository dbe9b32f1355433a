"""Closed forms are met with the declared order of convergence, and independent formulas exactly."""

import numpy as np
import pytest

from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from tests.fractional import oracles

ORDERS = (0.1, 0.5, 0.9)
OPERATORS = (FractionalDerivative, FractionalIntegral)


def relative_error(operator, name, duration=10.0, first=1, number=100):
    function = oracles.FUNCTIONS[name]
    count = round(duration / operator.dt)
    t = np.arange(count + 1) * operator.dt
    chosen = oracles.instants(count, number)
    chosen = chosen[chosen >= first]
    values = operator.stream(1).update_many(function(t)[:, None])[chosen, 0]
    law = function.derivative if isinstance(operator, FractionalDerivative) else function.integral
    exact = law(operator.order, t[chosen])
    return np.max(np.abs(values - exact)) / np.max(np.abs(exact))


# max |err| / max |exact|, the worst of t^2, sin 10t and e^-t on (0, 10 s] at 1 ms
LINEAR = {0.1: 9.5e-6, 0.5: 2.5e-4, 0.9: 3.5e-3}
QUADRATIC = {0.1: 6.5e-8, 0.5: 1.5e-6, 0.9: 2.5e-5}


@pytest.mark.parametrize("name", ["t^2", "sin 10t", "e^-t"])
@pytest.mark.parametrize("order", ORDERS)
def test_derivative_at_1_ms(order, name):
    linear = FractionalDerivative(order=order, dt=1e-3)
    quadratic = FractionalDerivative(order=order, dt=1e-3, scheme="quadratic")
    assert relative_error(linear, name) < LINEAR[order]
    # Two samples cannot show a curvature: the second is taken as the linear scheme takes it.
    assert relative_error(quadratic, name, first=2) < QUADRATIC[order]
    assert relative_error(quadratic, name) < LINEAR[order]


@pytest.mark.parametrize("name", ["t^2", "sin 10t", "e^-t"])
@pytest.mark.parametrize("order", ORDERS)
def test_integral_at_1_ms(order, name):
    assert relative_error(FractionalIntegral(order=order, dt=1e-3), name) < 8.5e-6
    quadratic = FractionalIntegral(order=order, dt=1e-3, scheme="quadratic")
    assert relative_error(quadratic, name) < 3.5e-8


@pytest.mark.parametrize("name", ["t^1.5", "cos 7t e^-t"])
@pytest.mark.parametrize("scheme", ["linear", "quadratic"])
@pytest.mark.parametrize("order", ORDERS)
def test_less_smooth_starts_at_1_ms(order, scheme, name):
    bound = {0.1: 3e-6, 0.5: 1.5e-4, 0.9: 2.5e-3}[order]
    assert relative_error(FractionalDerivative(order=order, dt=1e-3, scheme=scheme), name) < bound
    assert relative_error(FractionalIntegral(order=order, dt=1e-3, scheme=scheme), name) < 4e-6


DECLARED = [
    (FractionalDerivative, "linear", 0.5, 1.5),
    (FractionalDerivative, "linear", 0.9, 1.1),
    (FractionalDerivative, "quadratic", 0.5, 2.5),
    (FractionalDerivative, "quadratic", 0.9, 2.1),
    (FractionalDerivative, "grunwald-letnikov", 0.5, 1.0),
    (FractionalIntegral, "linear", 0.1, 2.0),
    (FractionalIntegral, "linear", 0.5, 2.0),
    (FractionalIntegral, "linear", 0.9, 2.0),
    (FractionalIntegral, "quadratic", 0.5, 3.0),
    (FractionalIntegral, "quadratic", 0.9, 3.0),
    (FractionalIntegral, "grunwald-letnikov", 0.5, 1.0),
]


@pytest.mark.parametrize(("kind", "scheme", "order", "declared"), DECLARED)
def test_observed_order_of_convergence(kind, scheme, order, declared):
    """At fixed times of sin 10t; t^2, whose start is smooth enough, for Grünwald-Letnikov."""
    name = "t^2" if scheme == "grunwald-letnikov" else "sin 10t"
    steps = np.array([4e-3, 2e-3, 1e-3])
    errors = [
        relative_error(
            kind(order=order, dt=dt, scheme=scheme, tolerance=1e-11),
            name,
            duration=2.0,
            first=round(0.08 / dt),
        )
        for dt in steps
    ]
    observed = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert observed == pytest.approx(declared, abs=0.15)


@pytest.mark.parametrize("jitter", [0.0, 0.3])
@pytest.mark.parametrize("order", ORDERS)
def test_linear_scheme_is_the_full_history_formula(order, jitter):
    rng = np.random.default_rng(1)
    periods = 1e-3 * (1 + jitter * rng.uniform(-1, 1, 800))
    t = np.cumsum(periods) - periods[0]
    x = np.cumsum(rng.normal(size=800))
    for kind, oracle in zip(
        OPERATORS, (oracles.l1_derivative, oracles.trapezoidal_integral), strict=True
    ):
        stream = kind(order=order, dt=1e-3).stream(1)
        values = stream.update_many(x[:, None], periods)[:, 0]
        exact = oracle(order, x, t)
        assert np.max(np.abs(values - exact)) < 1e-7 * np.max(np.abs(exact))


@pytest.mark.parametrize("tempering", [0.0, 5.0])
@pytest.mark.parametrize("order", [0.01, 0.1, 0.5, 0.9, 1.0])
def test_grunwald_letnikov_is_the_full_history_formula(order, tempering):
    x = np.random.default_rng(2).normal(size=500)
    shared = {"order": order, "dt": 1e-3, "scheme": "grunwald-letnikov", "tempering": tempering}
    derivative = FractionalDerivative(definition="riemann-liouville", **shared).stream(1)
    integral = FractionalIntegral(**shared).stream(1)
    for stream, signed in ((derivative, order), (integral, -order)):
        exact = oracles.grunwald_letnikov(signed, x, 1e-3, tempering)
        values = stream.update_many(x[:, None])[:, 0]
        assert np.max(np.abs(values - exact)) < 1e-8 * np.max(np.abs(exact))
    start = x[0] * np.exp(-tempering * 1e-3 * np.arange(500))
    caputo = FractionalDerivative(**shared).stream(1).update_many(x[:, None])[:, 0]
    exact = oracles.grunwald_letnikov(order, x - start, 1e-3, tempering)
    assert np.max(np.abs(caputo - exact)) < 1e-8 * np.max(np.abs(exact))


@pytest.mark.parametrize("scheme", ["linear", "quadratic", "grunwald-letnikov"])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("kind", OPERATORS)
def test_a_jittering_clock_at_most_doubles_the_error(kind, order, scheme):
    function, dt = oracles.FUNCTIONS["t^2" if scheme == "grunwald-letnikov" else "sin 10t"], 1e-3
    periods = dt * (1 + 0.3 * np.random.default_rng(3).uniform(-1, 1, 4001))
    errors = []
    for clock in (np.full(4001, dt), periods):
        t = np.cumsum(clock) - clock[0]
        x = function(t)[:, None]
        values = kind(order=order, dt=dt, scheme=scheme).stream(1).update_many(x, clock)[:, 0]
        chosen = np.arange(40, 4001, 40)
        law = function.derivative if kind is FractionalDerivative else function.integral
        errors.append(np.max(np.abs(values[chosen] - law(order, t[chosen]))))
    assert errors[1] < 2 * errors[0]


@pytest.mark.parametrize("scheme", ["linear", "quadratic", "grunwald-letnikov"])
@pytest.mark.parametrize("sigma", [0.5, 20.0])
def test_tempering_is_a_shift_of_the_transform(scheme, sigma):
    """`(s+σ)^α`: the operator of `e^{-σt} g` is `e^{-σt}` times the pure one of `g`."""
    t = np.arange(1001) * 1e-3
    g, fade = 1 + oracles.FUNCTIONS["t^2"](t), np.exp(-sigma * t)
    for kind in OPERATORS:
        pure = kind(order=0.4, dt=1e-3, scheme=scheme)
        tempered = kind(order=0.4, dt=1e-3, scheme=scheme, tempering=sigma)
        expected = fade * pure.stream(1).update_many(g[:, None])[:, 0]
        values = tempered.stream(1).update_many((fade * g)[:, None])[:, 0]
        # Between samples either x or e^{σt} x is a polynomial; Grünwald-Letnikov sees no between.
        bound = 1e-7 if scheme == "grunwald-letnikov" else (sigma + 3) ** 2 * 1e-3**1.5
        assert np.max(np.abs(values - expected)) < bound


def test_riemann_liouville_adds_the_answer_to_the_start():
    t = np.arange(2001) * 1e-3
    x = np.full((2001, 1), 3.0)
    for scheme in ("linear", "quadratic"):
        operator = FractionalDerivative(
            order=0.5, dt=1e-3, scheme=scheme, definition="riemann-liouville"
        )
        values = operator.stream(1).update_many(x)[1:, 0]
        np.testing.assert_allclose(values, 3.0 / np.sqrt(np.pi * t[1:]), rtol=1e-8)


@pytest.mark.parametrize("order", [0.3, 0.5, 0.9])
def test_fractional_relaxation_is_mittag_leffler(order):
    """`D^α y = -y`, `y(0) = 1`, each step solved with the gain that `predict` gives."""
    from fotsmc_pin.fractional import commit, predict

    dt, count = 2e-3, 1500
    stream = FractionalDerivative(order=order, dt=dt).stream(1)
    stream.update([1.0])
    history, y = np.empty(1), np.empty(count + 1)
    y[0] = 1.0
    for n in range(1, count + 1):
        gain = predict(stream.coefficients, stream.memory, dt, history)
        y[n] = -history[0] / (1.0 + gain)
        commit(stream.coefficients, stream.memory, y[n : n + 1], dt)
    for n in (250, 1500):
        assert y[n] == pytest.approx(oracles.mittag_leffler(order, -((n * dt) ** order)), rel=2e-3)


@pytest.mark.parametrize("scheme", ["linear", "quadratic"])
def test_no_growth_over_1000_s(scheme):
    t = np.arange(0.0, 1000.0, 5e-3)
    x = np.sin(10 * t)[:, None]
    values = FractionalDerivative(order=0.5, dt=5e-3, scheme=scheme).stream(1).update_many(x)
    steady = np.sqrt(10) * np.sin(10 * t + np.pi / 4)
    error = np.abs(values[:, 0] - steady)
    assert error[t > 900].max() <= 1.01 * error[(t > 100) & (t < 200)].max()
