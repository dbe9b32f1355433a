"""The braking path: it begins as the arm moves, and moves no farther than torque limits demand."""

import numpy as np
import pytest
from scipy.optimize import linprog

import fotsmc_pin as fp
from fotsmc_pin.control.safety.braking_kernels import HARDER, LADEN, LONGEST, SHARE
from fotsmc_pin.control.safety.braking_path import BrakingPath

LEAST, DT = 0.1, 1e-3


def moving(arm, seed):
    rng = np.random.default_rng(seed)
    q = arm.random_configuration(rng)
    v = rng.choice([-1.0, 1.0], arm.nv) * rng.uniform(0.5, 1.0, arm.nv) * arm.velocity_limit
    return q, v, arm.mass_matrix(q), arm.inverse_dynamics(q, v, np.zeros(arm.nv))


def begun(arm, q, v, a=0.0, true=None, **options):
    path, nothing = BrakingPath(arm, LEAST, **options), np.zeros(arm.nv)
    h = arm.inverse_dynamics(q, v, nothing)
    unknown = (true or arm).inverse_dynamics(q, v, nothing) - h
    path.begin((q, v, nothing + a), arm.mass_matrix(q), h, unknown)
    return path


def followed(path, true, arm, q, v, ticks=600):
    """The path, and the torques that it asks of an arm that follows it."""
    rows, tau = [], true.inverse_dynamics(q, v, np.zeros(arm.nv))
    for _ in range(ticks):
        M, h = arm.mass_matrix(q), arm.inverse_dynamics(q, v, np.zeros(arm.nv))
        q, v, a = path.advance(M, h, tau, DT)
        tau = true.inverse_dynamics(q, v, a)
        rows.append((q, v, a, tau))
    return [np.array(part) for part in zip(*rows, strict=True)]


def least_way(arm, v, M, h):
    """The least way of the joint that moves farthest, by a linear program and bisection."""
    size, room = np.abs(v), SHARE * arm.effort_limit
    matrix = LADEN * M * np.sign(v)
    rows, ends = np.r_[matrix, -matrix], np.r_[room + h, room - h]
    short, long = 0.5 * size.max() * LEAST, 0.5 * size.max() * LONGEST
    for _ in range(20):
        way = 0.5 * (short + long)
        most = size * HARDER / LEAST
        least = np.maximum(size / LONGEST, size**2 / (2.0 * way))
        done = linprog(np.ones(arm.nv), A_ub=rows, b_ub=ends, bounds=np.c_[least, most])
        short, long = (short, way) if done.status == 0 else (way, long)
    return long


@pytest.mark.parametrize(("name", "seed"), [("panda", 0), ("panda", 3), ("ur5", 1), ("z1", 2)])
def test_the_way_is_the_least_that_the_torques_allow(name, seed):
    arm = fp.load_arm(name)
    q, v, M, h = moving(arm, seed)
    way, best = begun(arm, q, v).bound, least_way(arm, v, M, h)
    assert best < 0.499 * np.abs(v).max() * LONGEST, "no path keeps the torques"
    assert way == pytest.approx(max(best, 0.2), rel=0.02)


@pytest.mark.parametrize("name", ["panda", "kinova", "slow"])
def test_it_begins_with_the_motion_and_ends_at_rest(name):
    arm = fp.load_arm("panda" if name == "slow" else name)
    q, v, *_ = moving(arm, 5)
    if name == "slow":  # speeds that the acceleration at the start turns around
        v = 1e-3 * v
    path = begun(arm, q, v, a=2.0)
    places, speeds, rates, _ = followed(path, arm, arm, q, v)
    ways = np.array([arm.difference(q, place) for place in places])
    np.testing.assert_allclose(speeds[0], v, atol=0.05)
    np.testing.assert_allclose(np.gradient(ways, DT, axis=0)[1:-1], speeds[1:-1], atol=5e-3)
    np.testing.assert_allclose(speeds[-1], 0.0, atol=1e-12)
    assert (np.abs(speeds) <= np.abs(v) + 0.04).all()
    assert np.abs(np.diff(rates, axis=0)).max() < 5.0


@pytest.mark.parametrize(("name", "seed"), [("ur5", 1), ("ur5", 4), ("panda", 3)])
def test_the_torques_of_an_unknown_payload_stay_within_their_limits(name, seed):
    arm = fp.load_arm(name)
    true = fp.perturb(arm, payload=2.0)
    q, v, *_ = moving(arm, seed)
    assert np.abs(true.inverse_dynamics(q, v, np.zeros(arm.nv)) / arm.effort_limit).max() < 0.9
    *_, tau = followed(begun(arm, q, v, true=true), true, arm, q, v)
    assert np.abs(tau / arm.effort_limit).max() < 1.05


def test_the_torque_rate_limits_how_the_deceleration_rises():
    arm = fp.load_arm("panda")
    q, v, *_ = moving(arm, 3)
    rates = []
    for limit in (np.inf, 300.0):
        path = begun(arm, q, v, torque_rate=np.full(arm.nv, limit))
        *_, tau = followed(path, arm, arm, q, v, ticks=50)
        rates.append(np.abs(np.diff(tau, axis=0)).max() / DT)
    assert rates[0] > 300.0 > rates[1]
