"""Finite differences of a reference, right for continuous joints too."""

import numpy as np
import pytest


@pytest.fixture
def assert_exact_derivatives():
    def check(arm, reference, times, tolerance=1e-5):
        h = 1e-4
        for t in times:
            _, v, a = reference(t)
            ahead, behind = reference(t + h), reference(t - h)
            v_numeric = arm.difference(behind[0], ahead[0]) / (2 * h)
            a_numeric = (ahead[1] - behind[1]) / (2 * h)
            scale = 1.0 + np.abs(a).max()
            np.testing.assert_allclose(v, v_numeric, rtol=0, atol=tolerance * scale)
            np.testing.assert_allclose(a, a_numeric, rtol=0, atol=tolerance * scale)

    return check


@pytest.fixture
def waypoints():
    """Three configurations well inside an arm's limits."""

    def make(arm, count=3, seed=0):
        rng = np.random.default_rng(seed)
        middle = arm.to_joint_positions(arm.neutral)
        shrunk = [
            middle + 0.4 * (arm.to_joint_positions(arm.random_configuration(rng)) - middle)
            for _ in range(count)
        ]
        return np.array([arm.from_joint_positions(x) for x in shrunk])

    return make
