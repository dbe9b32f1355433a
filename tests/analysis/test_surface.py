"""The surface against Mittag-Leffler's series, its own equation, and a simulated arm."""

import math

import mpmath
import numpy as np
import pytest

from fotsmc_pin.analysis import sector_margin, surface_decay, surface_margin
from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import FONFTSM
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional import FractionalDerivative
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import simulate


def mittag_leffler(beta, second, z):
    """The series, in so many digits that its cancellation does no harm."""
    with mpmath.workdps(80):
        terms = (z**k / mpmath.gamma(beta * k + second) for k in range(300))
        return mpmath.fsum(terms)


@pytest.mark.parametrize("alpha", [0.02, 0.1, 0.3, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("t", [0.0, 1e-4, 0.3, 1.0, 3.0])
def test_decay_is_mittag_lefflers_function(alpha, t):
    a, beta = 3.0, mpmath.mpf(1.0 + alpha)
    z = -a * mpmath.mpf(t) ** beta
    start = mittag_leffler(beta, 1, z)
    speed = t * mittag_leffler(beta, 2, z)
    found = surface_decay(t, alpha=alpha, a=a, e_start=2.0, ed_start=-0.7)
    assert found[0] == pytest.approx(float(2.0 * start - 0.7 * speed), abs=1e-10)


def test_decay_of_order_zero_is_an_exponential():
    t = np.linspace(0.0, 2.0, 21)
    np.testing.assert_allclose(
        surface_decay(t, alpha=0.0, a=4.0, e_start=0.5), 0.5 * np.exp(-4.0 * t), rtol=1e-15
    )


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_decay_ends_in_the_algebraic_tails_of_r8(alpha):
    t, a = np.array([1e3, 2e3]), 10.0
    start = surface_decay(t, alpha=alpha, a=a, e_start=1.0)
    speed = surface_decay(t, alpha=alpha, a=a, e_start=0.0, ed_start=1.0)
    np.testing.assert_allclose(start, t ** -(1 + alpha) / (a * math.gamma(-alpha)), rtol=2e-2)
    np.testing.assert_allclose(speed, t**-alpha / (a * math.gamma(1 - alpha)), rtol=2e-2)


def test_decay_solves_the_equation_of_the_surface():
    """Fed back into the streaming operator, the speed of the decay leaves no `S`."""
    alpha, a, dt = 0.4, 5.0, 1e-3
    t = dt * np.arange(2001)
    e = surface_decay(t, alpha=alpha, a=a, e_start=0.3, ed_start=0.8)
    e_dot = np.gradient(e, dt, edge_order=2)
    e_dot[0] = 0.8
    stream = FractionalDerivative(order=alpha, dt=dt, scheme="quadratic").stream(1)
    S = np.array([stream.update([value])[0] for value in e_dot]) + a * e
    assert np.abs(S[100:]).max() < 1e-3 * np.abs(a * e).max()


def test_an_arm_on_its_surface_decays_as_predicted():
    """With `S` held near zero from the start, the simulated error is the predicted one."""
    arm = load_arm("two_link", effort_limit=1e6)
    alpha, a = 0.3, 6.0
    controller = FONFTSM(
        arm,
        1e-3,
        preset="practical",
        alpha=alpha,
        A=a,
        lam=0.0,
        theta=300.0,
        tempering=0.0,
        B0=0.0,
        B1=0.0,
    )
    hold = Hold(arm)
    rec = simulate(arm, controller, hold, 2.0, q0=arm.integrate(arm.neutral, [0.1, -0.1]))
    reached = np.flatnonzero(np.abs(rec.signals["s"]).max(axis=1) < 2e-2 * a * 0.1)[0]
    assert rec.t[reached] < 0.1
    predicted = surface_decay(rec.t, alpha=alpha, a=a, e_start=0.1)
    assert np.abs(rec.e[:, 0] - predicted).max() < 0.1 * 0.1
    tail = rec.t > 1.0
    assert np.abs(rec.e[tail, 0] - predicted[tail]).max() < 0.1 * np.abs(predicted[tail]).max()


class TestMatignonsSector:
    @pytest.mark.parametrize("alpha", [0.0, 0.1, 0.5, 0.99])
    def test_the_surface_has_the_margin_of_its_order_whatever_its_gains(self, alpha):
        for A in (3.0, [1.0, 50.0, 0.2]):
            assert surface_margin(alpha, A) == pytest.approx((1.0 - alpha) * math.pi / 2.0)

    def test_a_negative_gain_is_unstable(self):
        assert surface_margin(0.1, [10.0, -1.0]) < 0.0

    def test_zero_is_on_the_unstable_side(self):
        assert sector_margin(np.diag([0.0, -1.0]), 0.5) < 0.0

    @pytest.mark.parametrize("order", [0.3, 1.0, 1.6])
    @pytest.mark.parametrize("angle", [0.4, 1.2, 2.0, 2.9])
    def test_the_sector_is_measured_from_the_eigenvalues(self, order, angle):
        c, s = math.cos(angle), math.sin(angle)
        matrix = 3.0 * np.array([[c, -s], [s, c]])
        assert sector_margin(matrix, order) == pytest.approx(angle - order * math.pi / 2.0)

    def test_the_sign_of_the_margin_tells_growth_from_decay(self):
        """`D^β x = λ x` with `λ` on both sides of the sector's edge, solved by Mittag-Leffler."""
        beta = 1.4
        for shift in (-0.05, 0.05):
            angle = beta * math.pi / 2.0 + shift
            eigenvalue = mpmath.mpc(math.cos(angle), math.sin(angle))
            early, late = (
                abs(mittag_leffler(mpmath.mpf(beta), 1, eigenvalue * mpmath.mpf(t) ** beta))
                for t in (5.0, 15.0)
            )
            c, s = math.cos(angle), math.sin(angle)
            margin = sector_margin([[c, -s], [s, c]], beta)
            assert (late < early) == (margin > 0.0)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: surface_decay(1.0, alpha=1.0, a=1.0, e_start=1.0), "alpha"),
        (lambda: surface_decay(1.0, alpha=1e-4, a=1.0, e_start=1.0), "alpha"),
        (lambda: surface_decay(1.0, alpha=0.1, a=0.0, e_start=1.0), "a"),
        (lambda: surface_decay(-1.0, alpha=0.1, a=1.0, e_start=1.0), "t"),
        (lambda: surface_decay(1.0, alpha=0.1, a=1.0, e_start=math.nan), "e_start"),
        (lambda: surface_margin(1.0, 1.0), "alpha"),
        (lambda: sector_margin(-1.0, 2.0), "order"),
        (lambda: sector_margin([[1.0, 2.0]], 0.5), "matrix"),
        (lambda: sector_margin([[math.inf]], 0.5), "matrix"),
    ],
)
def test_bad_arguments_are_named(call, name):
    with pytest.raises(ArgumentError) as caught:
        call()
    assert caught.value.argument == name
