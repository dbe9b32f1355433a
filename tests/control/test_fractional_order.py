"""`α → 0` takes the fractional laws to their integer-order form; measured periods are obeyed."""

from itertools import pairwise

import numpy as np
import pytest

from fotsmc_pin.analysis import surface_decay
from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import (
    FONFTSM,
    AdaptiveFONFTSM,
    FractionalSwitchingSMC,
    LinearSMC,
)
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import simulate

ORDERS = (1e-2, 1e-3, 1e-4)


@pytest.mark.parametrize(
    ("law", "gains"),
    [
        (FONFTSM, {"switching": "tanh"}),
        (FONFTSM, {"switching": "tanh", "inertia": "outside"}),
        (AdaptiveFONFTSM, {"switching": "tanh"}),
        (FractionalSwitchingSMC, {"switching": "tanh"}),
    ],
)
def test_the_torque_goes_to_the_integer_orders_in_proportion_to_alpha(
    law, gains, arm, make, wander
):
    rows = list(wander(arm, 80))  # starts at rest: Caputo's D^α forgets a first value
    integer = make(law, arm, alpha=0.0, **gains)
    expected = np.array([integer.update(*row) for row in rows])
    scale = np.abs(expected).max()
    differences = []
    for alpha in ORDERS:
        controller = make(law, arm, alpha=alpha, **gains)
        tau = np.array([controller.update(*row) for row in rows])
        # The first sample of an integral of positive order has no time behind it yet.
        differences.append(np.abs(tau - expected)[1:].max() / scale)
    assert differences[-1] < 1e-2
    for large, small in pairwise(differences):
        assert small < 0.2 * large


def test_fractional_switching_of_order_zero_is_linear_sliding_mode(arm, make, wander):
    fractional = make(FractionalSwitchingSMC, arm, alpha=0.0, eta=5.0)
    linear = make(LinearSMC, arm, eta=5.0)
    for row in wander(arm, 50):
        np.testing.assert_allclose(fractional.update(*row), linear.update(*row), rtol=1e-12)


def test_fonftsm_of_order_zero_is_a_terminal_law_around_inverse_dynamics(arm, make, wander):
    g = {"A": 7.0, "lam": 1.5, "power": 1.2, "theta": 4.0, "mu": 0.8, "B0": 2.0, "B1": 0.5}
    controller = make(FONFTSM, arm, alpha=0.0, inertia="outside", **g)
    controller.joints.effort_limit[:] = np.inf
    for q, v, q_d, v_d, a_d in wander(arm, 50):
        e, ed = arm.difference(q_d, q), v - v_d
        S = ed + 7.0 * e + 1.5 * np.abs(e) ** 1.2 * np.sign(e)
        slope = 7.0 + 1.5 * 1.2 * np.maximum(np.abs(e), 1e-3) ** 0.2
        reach = 4.0 * (S + np.abs(S) ** 0.8 * np.sign(S))
        a = a_d - reach - slope * ed - (2.0 + 0.5 * np.linalg.norm(v)) * np.sign(S)
        np.testing.assert_allclose(
            controller.update(q, v, q_d, v_d, a_d), arm.inverse_dynamics(q, v, a), rtol=1e-9
        )


def test_a_measured_period_counts(case, arms, make, wander):
    """Every law with memory hears of the time that passed; the others cannot tell."""
    law, preset = case
    arm = arms["two_link"]
    nominal, told = make(law, arm, preset), make(law, arm, preset)
    remembers = bool(nominal.memories) or nominal.preset == "pid" or law.__name__ in REMEMBERING
    apart = 0.0
    for row in wander(arm, 30):
        apart = max(apart, np.abs(nominal.update(*row) - told.update(*row, dt=1.7e-3)).max())
    assert (apart > 0.0) == remembers


REMEMBERING = {"SuperTwistingSMC"}


@pytest.mark.parametrize("law", [FONFTSM, FractionalSwitchingSMC])
def test_two_ticks_of_half_a_period_see_what_the_clock_says(law, arms, make):
    """The torque after 40 ms is nearly the same, however the time was cut into ticks."""
    arm = arms["two_link"]
    rest = np.zeros(2)

    def torque_after(periods):
        controller, t = make(law, arm, "practical" if law is FONFTSM else "boundary_layer"), 0.0
        for period in (1e-3, *periods):
            e = 0.1 * (1.0 - np.cos(20.0 * t))
            ed = 2.0 * np.sin(20.0 * t)
            q, v = arm.neutral + e, rest + ed
            tau = controller.update(q, v, arm.neutral, rest, rest, dt=period)
            t += period
        return tau

    even = torque_after([1e-3] * 40)
    jittered = torque_after([0.5e-3, 1.5e-3] * 20)
    unaware = torque_after([0.5e-3] * 40)
    change = np.abs(even).max()
    assert np.abs(jittered - even).max() < 0.1 * change
    assert np.abs(unaware - even).max() > 0.1 * change


def test_a_start_in_motion_leaves_a_tail_only_where_its_speed_is_forgotten(make):
    """Reading R7: Caputo's derivative forgets `ė(0)`, and the error pays for it with `t^{-α}`."""
    arm = load_arm("two_link", effort_limit=1e6)
    errors = {}
    for start in ("caputo", "from_rest"):
        controller = make(FONFTSM, arm, start=start)
        rec = simulate(arm, controller, Hold(arm), 3.0, v0=[1.0, 0.0])
        errors[start] = rec.e[-1, 0]
    tail = surface_decay(3.0, alpha=0.1, a=12.0, e_start=0.0, ed_start=1.0)[0]
    assert errors["caputo"] == pytest.approx(tail, rel=0.2)
    assert abs(errors["from_rest"]) < 0.05 * tail
