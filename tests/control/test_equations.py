"""Each law against its equations, written out once more in plain numpy and streaming operators."""

import numpy as np
import pytest

from fotsmc_pin.control import (
    FONFTSM,
    TDEFONTSM,
    AdaptiveFONFTSM,
    ComputedTorque,
    ContinuousTSM,
    FractionalSwitchingSMC,
    LinearSMC,
    NonsingularTSM,
    RobustFONFTSM,
    SuperTwistingSMC,
    TerminalSMC,
)
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from tests.control.robust_oracle import RobustOracle

DT = 1e-3
TICKS = 60


def sig(x, power):
    return np.abs(x) ** power * np.sign(x)


def switched(g, s):
    """The switching function that the gains name."""
    x = s / g.boundary_layer
    layer = np.abs(x) < 1.0
    return {
        "sign": np.sign(s),
        "saturation": np.where(layer, x, np.sign(s)),
        "tanh": np.tanh(x),
        "power": np.where(layer, sig(x, 0.5), np.sign(s)),
    }[g.switching]


class Tick:
    """One tick's terms, as the paper writes them."""

    def __init__(self, arm, row):
        self.q, self.v, q_d, self.v_d, self.a_d = row
        self.e, self.e_dot = arm.difference(q_d, self.q), self.v - self.v_d
        self.M0 = arm.mass_matrix(self.q)
        self.h0 = arm.coriolis(self.q, self.v) @ self.v + arm.gravity(self.q)

    def inverse_dynamics(self, a):
        return self.M0 @ a + self.h0


def operators(n, alpha, tempering=0.0):
    options = {"order": alpha, "dt": DT, "tempering": tempering}
    return FractionalDerivative(**options).stream(n), FractionalIntegral(**options).stream(n)


def fonftsm(g, n):
    derivative, integral = operators(n, g.alpha, g.tempering)
    if g.start == "from_rest":
        derivative.update(np.zeros(n))
    inside = g.inertia == "inside"
    if hasattr(g, "B0"):
        B = np.array([g.B0, g.B1])
        rates = np.zeros(2)
    else:
        B = np.array([g.B0_start, g.B1_start])
        rates = 1.0 / np.array([g.upsilon_0, g.upsilon_1])
    start = B.copy()

    def law(x):
        S = derivative.update(x.e_dot) + g.A * x.e + g.lam * sig(x.e, g.power)
        slope = g.power * np.maximum(np.abs(x.e), g.error_floor) ** (g.power - 1.0)
        inner = g.theta * (S + sig(S, g.mu)) + g.A * x.e_dot + g.lam * slope * x.e_dot
        switching = (B[0] + B[1] * np.linalg.norm(x.v)) * switched(g, S)
        if inside:
            tau = x.inverse_dynamics(x.a_d) - integral.update(x.M0 @ inner + switching)
        else:
            tau = x.inverse_dynamics(x.a_d - integral.update(inner + switching))
        B[:] += DT * rates * np.linalg.norm(S) * np.array([1.0, np.linalg.norm(x.v)])
        if getattr(g, "adaptation", "") == "leakage":
            B[:] = start + (B - start) * np.exp(-g.leakage * DT)
        return tau

    return law


def continuous_tsm(g, n):
    def law(x):
        s = x.e + g.beta * sig(x.e_dot, g.gamma)
        reach = g.K1 * s + g.K2 * sig(s, g.rho)
        return x.inverse_dynamics(x.a_d - sig(x.e_dot, 2.0 - g.gamma) / (g.beta * g.gamma) - reach)

    return law


def nonsingular_tsm(g, n):
    def law(x):
        s = x.e + g.beta * sig(x.e_dot, g.gamma)
        reach = g.K * s + g.eta * switched(g, s)
        return x.inverse_dynamics(x.a_d - sig(x.e_dot, 2.0 - g.gamma) / (g.beta * g.gamma) - reach)

    return law


def terminal_smc(g, n):
    def law(x):
        s = x.e_dot + g.beta * sig(x.e, g.power)
        slope = g.beta * g.power * np.maximum(np.abs(x.e), g.error_floor) ** (g.power - 1.0)
        return x.inverse_dynamics(x.a_d - slope * x.e_dot - g.K * s - g.eta * switched(g, s))

    return law


def linear_smc(g, n):
    def law(x):
        s = x.e_dot + g.Lambda * x.e
        return x.inverse_dynamics(x.a_d - g.Lambda * x.e_dot - g.K * s - g.eta * switched(g, s))

    return law


def super_twisting_smc(g, n):
    z = np.zeros(n)

    def law(x):
        s = x.e_dot + g.Lambda * x.e
        tau = x.inverse_dynamics(x.a_d - g.Lambda * x.e_dot - g.k1 * sig(s, 0.5) - z)
        z[:] += DT * g.k2 * switched(g, s)
        return tau

    return law


def computed_torque(g, n):
    z = np.zeros(n)

    def law(x):
        tau = x.inverse_dynamics(x.a_d - g.kd * x.e_dot - g.kp * x.e - z)
        z[:] += DT * g.ki * x.e
        return tau

    return law


def fractional_switching_smc(g, n):
    _, integral = operators(n, g.alpha, g.tempering)

    def law(x):
        s = x.e_dot + g.Lambda * x.e
        fractional = integral.update(switched(g, s))
        return x.inverse_dynamics(x.a_d - g.Lambda * x.e_dot - g.K * s - g.eta * fractional)

    return law


def tde_fontsm(g, n):
    _, integral = operators(n, g.alpha)
    derivative, _ = operators(n, 1.0 - g.alpha)
    estimate, last = np.zeros(n), {}

    def law(x):
        terminal = sig(x.e, g.power)
        s = x.e_dot + g.Lambda * x.e + g.k * integral.update(terminal)
        if last:
            fresh = last["tau"] - g.inertia * (x.v - last["v"]) / DT
            estimate[:] += (1.0 - np.exp(-g.filter_rate * DT)) * (fresh - estimate)
        u = x.a_d - g.Lambda * x.e_dot - g.k * derivative.update(terminal)
        u -= g.K1 * s + g.K2 * sig(s, g.rho)
        tau = estimate + g.inertia * u
        last.update(tau=tau, v=x.v)
        return tau

    return law


LAWS = [
    (RobustFONFTSM, "default", RobustOracle),
    (FONFTSM, "paper", fonftsm),
    (FONFTSM, "practical", fonftsm),
    (AdaptiveFONFTSM, "paper", fonftsm),
    (AdaptiveFONFTSM, "practical", fonftsm),
    (ContinuousTSM, "default", continuous_tsm),
    (NonsingularTSM, "sign", nonsingular_tsm),
    (NonsingularTSM, "boundary_layer", nonsingular_tsm),
    (TerminalSMC, "sign", terminal_smc),
    (TerminalSMC, "boundary_layer", terminal_smc),
    (LinearSMC, "sign", linear_smc),
    (LinearSMC, "boundary_layer", linear_smc),
    (SuperTwistingSMC, "sign", super_twisting_smc),
    (SuperTwistingSMC, "boundary_layer", super_twisting_smc),
    (ComputedTorque, "pid", computed_torque),
    (FractionalSwitchingSMC, "sign", fractional_switching_smc),
    (FractionalSwitchingSMC, "boundary_layer", fractional_switching_smc),
    (TDEFONTSM, "default", tde_fontsm),
]


@pytest.mark.parametrize(
    ("law", "preset", "written"), LAWS, ids=[f"{law.__name__}-{preset}" for law, preset, _ in LAWS]
)
def test_a_run_of_ticks_follows_the_equations(law, preset, written, arm, make, wander):
    controller = make(law, arm, preset)
    controller.joints.effort_limit[:] = np.inf
    expected = written(controller.gains, arm.nv)
    scale = 1.0
    for row in wander(arm, TICKS):
        wanted = expected(Tick(arm, row))
        scale = max(scale, np.abs(wanted).max())
        np.testing.assert_allclose(controller.update(*row), wanted, rtol=1e-8, atol=1e-10 * scale)


def held_still(arm, ticks):
    """A rest in which joints stick, slip past their goal and, from the middle on, oscillate."""
    rest = np.zeros(arm.nv)
    for k in range(ticks):
        slips = 1e-4 * np.sign(np.sin(2.0 * np.pi * k * DT * 2.5)) * np.linspace(0.5, 3.0, arm.nv)
        swing, rate = (0.0, 0.0) if 2 * k < ticks else (2e-3, 30.0)
        e = slips + swing * np.sin(rate * k * DT)
        e_dot = swing * rate * np.cos(rate * k * DT) * np.ones(arm.nv)
        yield arm.integrate(arm.neutral, e), e_dot, arm.neutral, rest, rest


def test_the_robust_law_follows_its_equations_at_rest(arm):
    """Sticking, hunting and the search for rotors all take part, and the equations still hold."""
    controller = RobustFONFTSM(arm, DT)
    controller.joints.effort_limit[:] = np.inf
    expected = RobustOracle(controller.gains, arm.nv)
    scale, took_part = 1.0, {"held": False, "allowed": False, "J": False}
    for row in held_still(arm, 6000):
        wanted = expected(Tick(arm, row))
        scale = max(scale, np.abs(wanted).max())
        np.testing.assert_allclose(controller.update(*row), wanted, rtol=1e-7, atol=1e-9 * scale)
        took_part = {
            part: seen or getattr(expected, part).any() for part, seen in took_part.items()
        }
    assert all(took_part.values()), took_part
