"""Controllers that are not, for tests of the plant and the loop alone."""

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm, perturb


class Held:
    """Asks for one torque for ever, or for what a function of `(q, v)` says."""

    def __init__(self, arm, dt, tau=0.0):
        self.dt, self.resets = dt, 0
        self.tau = tau if callable(tau) else lambda q, v: np.broadcast_to(tau, (arm.nv,))

    def update(self, q, v, q_d, v_d, a_d):
        return np.array(self.tau(q, v), dtype=float)

    def reset(self):
        self.resets += 1


@pytest.fixture(scope="session")
def held():
    return Held


@pytest.fixture(scope="session")
def arms():
    """Arms without friction: one in the plane, one in space, one with continuous joints."""
    return {
        "two_link": load_arm("two_link", effort_limit=1e9),
        "panda": perturb(load_arm("panda"), damping=0.0, friction=0.0),
        "kinova": load_arm("kinova"),
    }


@pytest.fixture(params=["two_link", "panda", "kinova"])
def arm(request, arms):
    return arms[request.param]
