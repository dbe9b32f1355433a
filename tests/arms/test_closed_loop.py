"""Every fixed-base arm of example-robot-data runs in closed loop against a plant it is not."""

import warnings

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms.catalog import EXAMPLE_ROBOTS
from fotsmc_pin.control import GravityWarning
from fotsmc_pin.references import Sinusoid

# Their files give no limits.
GIVEN = {"effort_limit": 20.0, "velocity_limit": 5.0}


@pytest.mark.parametrize("name", EXAMPLE_ROBOTS)
def test_torques_stay_finite_and_inside_the_limits(name):
    """How well it tracks is the law's affair; that it runs and stays in bounds is the arm's."""
    nominal = fp.load_arm(name, **(GIVEN if name.startswith("double_pendulum") else {}))
    moving_mass = sum(inertia.mass for inertia in nominal.model.inertias[1:])
    true = fp.perturb(nominal, mass_scale=1.1, com_shift=0.005, payload=0.02 * moving_mass, seed=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GravityWarning)  # talos_arm, baxter: that is known
        law = fp.AdaptiveFONFTSM(nominal, dt=1e-3, preset="practical")
    reference = Sinusoid.inside_limits(nominal)
    # Damping of 10 N·m·s on light wrists, as the xarm7 has, is stiff for an explicit integrator.
    rec = fp.simulate(true, law, reference, duration=3.0, integrator="semi-implicit")
    assert rec.q.shape == (3001, nominal.nq)
    assert rec.tau.shape == rec.e.shape == (3001, nominal.nv)
    assert np.isfinite(rec.tau).all()
    assert np.all(np.abs(rec.tau) <= nominal.effort_limit)
    assert np.abs(rec.e).max() < 0.5
