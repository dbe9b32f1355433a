"""What a stop finds the arm to carry, and what it does with that knowledge."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.safety.brake import Brake
from fotsmc_pin.control.safety.carried import Carried
from fotsmc_pin.control.safety.seen import Seen
from fotsmc_pin.control.safety.steps import RECENT, averaged, caught_up
from tests.robust.safe_stops import stop_once

DT = 1e-3


def moving(arm, seed, friction=0.0, payload=2.0):
    """A state, and the averages after a motion at an even acceleration that led there."""
    rng = np.random.default_rng(seed)
    q, v = arm.random_configuration(rng), rng.uniform(-1.0, 1.0, arm.nv) * arm.velocity_limit
    a = rng.uniform(-2.0, 2.0, arm.nv)
    true = fp.perturb(arm, payload=payload)  # a ball, where a point is sought
    seen = Seen(arm)
    seen.see(q, v)
    w = true.inverse_dynamics(q, v, a) - arm.inverse_dynamics(q, v, np.zeros(arm.nv))
    beyond = w + friction * np.sign(v)
    return seen, true, np.array([beyond, v - a / RECENT, beyond, v - a / RECENT]), a


@pytest.mark.parametrize("name", ["panda", "ur5", "kinova"])
@pytest.mark.parametrize("payload", [0.0, 1.0, 2.0])
def test_the_mass_is_found_and_its_model_is_that_of_the_arm_that_carries_it(name, payload):
    """Where the mass bears little on the motion, less is expected of it; never more."""
    arm, found = fp.load_arm(name), []
    for seed in range(8):
        seen, true, recent, a = moving(arm, seed, payload=payload)
        carried = Carried(arm)
        carried.find(seen, recent)
        found.append(carried.mass)
        assert 0.0 <= carried.mass <= 1.02 * payload + 1e-9
        carried.mass = payload
        M, h, beyond = carried.model(seen, recent)
        still = np.zeros(arm.nv)
        np.testing.assert_allclose(M, true.mass_matrix(seen.q), atol=2e-3)
        np.testing.assert_allclose(h, true.inverse_dynamics(seen.q, seen.v, still), atol=0.02)
        np.testing.assert_allclose(beyond[0] - M @ a, 0.0, atol=0.02)
    assert np.median(found) == pytest.approx(payload, rel=0.2, abs=1e-9)


def test_friction_alone_is_no_great_mass_and_what_pulls_upward_is_none():
    arm = fp.load_arm("panda")
    for seed in range(8):
        seen, _, recent, _ = moving(arm, seed, friction=0.5, payload=0.0)
        carried = Carried(arm)
        carried.find(seen, recent)
        assert carried.mass < 0.4
        carried.find(seen, -moving(arm, seed)[2])
        assert carried.mass == 0.0


def test_averages_that_are_caught_up_do_not_lag_behind_what_rises_evenly():
    recent, slope = np.zeros((4, 2)), np.array([30.0, -5.0])
    for k in range(200):
        t = DT * k
        averaged(slope * t, np.zeros(2), 2.0 * slope * t, DT, recent)
    assert (np.abs(recent[0] - slope * t) > 0.008 * np.abs(slope)).all()
    caught_up(recent)
    np.testing.assert_allclose(recent[0], slope * t, atol=1e-6)
    np.testing.assert_allclose(recent[1], 2.0 * slope * t, atol=1e-6)


def test_a_joint_at_rest_is_not_pulled_to_where_its_path_ended():
    arm = fp.load_arm("two_link")
    still, e = np.zeros(2), np.array([0.01, -0.02])
    brake, M, recent = Brake(arm, DT), arm.mass_matrix(arm.neutral), np.zeros((4, 2))
    brake.begin(still)
    moves = brake.torque(e, still + 0.1, (still, still), M, still, recent, DT, sees=True)
    assert np.abs(moves).max() > 1e-3
    held = brake.torque(e, still, (still, still), M, still, recent, DT, sees=True)
    np.testing.assert_allclose(held, 0.0, atol=1e-12)
    pushed = brake.torque(e + 0.01, still, (still, still), M, still, recent, DT, sees=True)
    assert (pushed * np.linalg.solve(M, pushed) > 0.0).any()


@pytest.mark.parametrize(("name", "seed"), [("kinova", 1), ("panda", 15)])
def test_a_stop_without_the_law_makes_no_joint_faster(name, seed):
    """Without the mass, and with a load that is dropped, they reached 4.9 and 1.4 times."""
    stop = stop_once(name, (), seed=seed, friction=0.5, trust_law=False)
    assert stop.rest < 0.7
    assert stop.way < 0.3
    assert stop.speed < 1.02


def test_a_law_that_makes_a_joint_faster_is_not_followed():
    stop = stop_once("panda", (), seed=15, friction=0.5)
    assert not stop.by_law
    assert stop.speed < 1.03
