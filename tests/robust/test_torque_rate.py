"""A limit of the torque's rate must not make a loop unstable that is stable without one."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.safety.steps import within_limits
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import Encoder, TickDelay
from tests.robust.safe_stops import stop_once

DT = 1e-3


def sent(demand, rate, limit=100.0):
    """What is sent of a torque that is wanted tick by tick."""
    tau, lag, none, found = np.zeros(1), np.zeros(1), np.zeros(1), []
    for wanted in demand:
        now = np.array([wanted])
        within_limits(now, tau, tau, none, np.array([rate]), np.array([limit]), lag, DT)
        tau = now
        found.append(now[0])
    return np.array(found)


def test_the_torque_turns_as_soon_as_the_demand_does():
    t = DT * np.arange(400)
    demand = 80.0 * np.sin(2.0 * np.pi * 5.0 * t)  # its rate is 2500 N·m/s at most
    tau = sent(demand, 500.0)
    assert (np.abs(np.diff(tau)) <= 500.0 * DT + 1e-12).all()
    turns = np.abs(np.diff(demand)) > 1.0 / 50.0 * 80.0  # faster than a lag is made up for
    assert (np.sign(np.diff(tau)) == np.sign(np.diff(demand)))[turns].all()


def test_it_makes_up_for_what_it_lags_behind():
    tau = sent(np.r_[np.zeros(10), np.full(600, 60.0)], 500.0)
    assert np.abs(tau[:10]).max() == 0.0
    assert tau[70] < 40.0
    assert tau[-1] == 60.0


def test_a_demand_within_the_rate_is_sent_bit_for_bit():
    demand = 30.0 * np.sin(0.3 * np.arange(300) * DT)
    assert (sent(demand, 500.0) == demand).all()
    beyond = 3.0 * demand * 40.0
    assert (sent(beyond, np.inf) == np.clip(beyond, -100.0, 100.0)).all()


@pytest.mark.parametrize(
    ("name", "rate", "bits", "error"), [("panda", 900.0, None, 1e-3), ("ur5", 2000.0, 17, 0.02)]
)
def test_it_holds(name, rate, bits, error):
    """At the start the torque comes from zero, and the arm begins to fall."""
    arm = fp.load_arm(name)
    true = fp.perturb(arm, mass_scale=1.2, payload=1.0, friction=0.3, damping=0.3)
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, DT), torque_rate=rate, soft_start=0.5)
    rec = fp.simulate(
        true,
        controller,
        Hold(arm),
        2.5,
        sensor=Encoder(arm, DT, bits=bits) if bits else None,
        actuator=TickDelay(1),
        integrator="semi-implicit",
    )
    assert controller.stopped is None
    assert np.abs(rec.e[1500:]).max() < error


def test_it_stops_from_full_speed():
    found = stop_once("panda", ("gravity",), friction=0.5, torque_rate=900.0)
    assert found.broke is None
    assert found.by_law
    assert found.rest < 1.0
    assert found.speed < 1.02
    assert found.way < 0.6
