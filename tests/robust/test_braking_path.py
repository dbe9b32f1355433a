"""The braking path: a motion that begins as the arm moves, and the least way that torques allow."""

import numpy as np
import pytest
from scipy.optimize import linprog

import fotsmc_pin as fp
from fotsmc_pin.control.safety.braking_path import (
    LONGEST,
    PEAK,
    SHARE,
    BrakingPath,
    braking_times,
)

START = 0.1


def moving(arm, seed):
    rng = np.random.default_rng(seed)
    q = arm.random_configuration(rng)
    v = rng.choice([-1.0, 1.0], arm.nv) * rng.uniform(0.5, 1.0, arm.nv) * arm.velocity_limit
    return q, v, arm.mass_matrix(q), arm.inverse_dynamics(q, v, np.zeros(arm.nv))


def least_way(arm, v, M, load, start):
    """The least way of the joint that moves farthest, by a linear program and bisection."""
    size, room = np.abs(v), SHARE * arm.effort_limit
    matrix = PEAK * M * np.sign(v)
    rows, ends = np.r_[matrix, -matrix], np.r_[room + load, room - load]
    short, long = 0.5 * size.max() * start, 0.5 * size.max() * LONGEST
    for _ in range(20):
        way = 0.5 * (short + long)
        most = size / start
        least = np.minimum(np.maximum(size / LONGEST, size**2 / (2.0 * way)), most)
        bounds = np.transpose([least, most])
        done = linprog(np.ones(arm.nv), A_ub=rows, b_ub=ends, bounds=bounds)
        short, long = (short, way) if done.status == 0 else (way, long)
    return long


@pytest.mark.parametrize(("name", "seed"), [("panda", 0), ("panda", 3), ("ur5", 1), ("z1", 2)])
def test_the_way_is_the_least_that_the_torques_allow(name, seed):
    arm = fp.load_arm(name)
    _, v, M, load = moving(arm, seed)
    T = np.zeros(arm.nv)
    braking_times(M, v, load, arm.effort_limit, START, T)
    start = min(max(START, 0.4 / np.abs(v).max()), 0.2)
    way, best = 0.5 * np.abs(v * T).max(), least_way(arm, v, M, load, start)
    assert best < 0.499 * np.abs(v).max() * LONGEST, "no path keeps the torques"
    assert way == pytest.approx(best, rel=0.02)
    asked = np.abs(load - PEAK * M @ (v / T))
    assert (asked <= 1.01 * SHARE * arm.effort_limit).all()
    assert T.min() >= start - 1e-12


def test_it_begins_with_the_motion_and_ends_at_rest():
    arm = fp.load_arm("panda")
    q, v, M, load = moving(arm, 5)
    a = np.full(arm.nv, 2.0)
    path = BrakingPath(arm)
    path.begin((q, v, a), M, load, START)
    rows = [path.advance(1e-4) for _ in range(6000)]
    places, speeds, rates = (np.array(part) for part in zip(*rows, strict=True))
    np.testing.assert_allclose(speeds[0], v, atol=1e-3)
    np.testing.assert_allclose(np.gradient(places, 1e-4, axis=0)[1:-1], speeds[1:-1], atol=1e-3)
    np.testing.assert_allclose(np.gradient(speeds, 1e-4, axis=0)[1:-1], rates[1:-1], atol=0.5)
    np.testing.assert_allclose(speeds[-1], 0.0, atol=1e-12)
    assert (np.abs(speeds) <= np.abs(v) + 0.01).all()
