"""Every controller with every preset, on three arms, fed with the same measurements."""

import warnings
from functools import cache

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import CONTROLLERS, PaperConditionWarning
from fotsmc_pin.references import Sinusoid

DT = 1e-3
CASES = [(law, preset) for law in CONTROLLERS.values() for preset in law.presets]


class Make:
    """Makes a controller; the paper's own gains break the paper's condition, which is known."""

    def __call__(self, law, arm, preset=None, dt=DT, **gains):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PaperConditionWarning)
            return law(arm, dt, preset=preset, **gains)


@cache
def rows_around(arm, ticks, seed, spread):
    """Return the rows of `wandering`, computed once for each arm; nobody writes into them."""
    rows = tuple(fresh_rows(arm, ticks, seed, spread))
    for row in rows:
        for array in row:
            array.setflags(write=False)
    return rows


def wandering(arm, ticks, seed=0, spread=0.05):
    """Measurements around a reference: rows `(q, v, q_d, v_d, a_d)`, smooth, at rest at first."""
    return [tuple(np.array(part) for part in row) for row in rows_around(arm, ticks, seed, spread)]


def fresh_rows(arm, ticks, seed, spread):
    rng = np.random.default_rng(seed)
    reference = Sinusoid.inside_limits(arm)
    phase, rate = rng.uniform(0.0, 6.0, arm.nv), rng.uniform(5.0, 20.0, arm.nv)
    for k in range(ticks):
        t = k * DT
        q_d, v_d, a_d = reference(t)
        e = spread * np.cos(phase) * np.cos(rate * t)
        ed = -spread * np.cos(phase) * rate * np.sin(rate * t)
        yield arm.integrate(q_d, e), v_d + ed, q_d, v_d, a_d


@pytest.fixture(scope="session")
def arms():
    return {name: load_arm(name) for name in ("two_link", "panda", "kinova")}


@pytest.fixture(params=["two_link", "panda", "kinova"])
def arm(request, arms):
    return arms[request.param]


@pytest.fixture(params=CASES, ids=[f"{law.__name__}-{preset}" for law, preset in CASES])
def case(request):
    """A law and one of its presets."""
    return request.param


@pytest.fixture
def make():
    return Make()


@pytest.fixture
def controller(case, arm, make):
    """A fresh controller for each case and arm."""
    law, preset = case
    return make(law, arm, preset)


@pytest.fixture
def another(case, arm, make):
    """Makes more controllers equal to `controller`."""
    law, preset = case
    return lambda: make(law, arm, preset)


@pytest.fixture
def wander():
    return wandering
