"""On a plant that is as the model says, every law takes its sliding variable to zero."""

import numpy as np
import pytest

from fotsmc_pin.control import FONFTSM, TDEFONTSM, AdaptiveFONFTSM
from fotsmc_pin.control.tde_fontsm import settling_inertia
from fotsmc_pin.references import Hold, Sinusoid
from fotsmc_pin.simulation import simulate


def gains_that_fit(law, preset, arm):
    """The paper's bounds are torques for its own arm: about 0.85 rad/s² on each of its joints.

    On a matched plant any bound is large enough, and the sign at 1 kHz cannot hold 5 N·m on the
    0.001 kg·m² of a wrist. Other arms get the bounds that mean the same acceleration.
    """
    if preset != "paper" or arm.name == "two_link":
        return {}
    bound = 0.85 * np.diag(arm.mass_matrix(arm.neutral)).min()
    if law is FONFTSM:
        return {"B0": bound, "B1": bound}
    return {"B0_start": bound, "B1_start": bound, "adaptation": "dead_zone", "dead_zone": 1e9}


@pytest.fixture
def run(case, arm, make):
    law, preset = case
    controller = make(law, arm, preset, **gains_that_fit(law, preset, arm))
    reference = Sinusoid.inside_limits(arm)
    start = arm.integrate(reference(0.0)[0], np.full(arm.nv, 0.05))
    return simulate(arm, controller, reference, 2.5, q0=start)


def test_the_surface_decreases(run):
    s = np.linalg.norm(run.signals.get("s", run.e), axis=1)
    start = s[:20].max()
    late = s[run.t > 2.0].max()
    assert late < 0.1 * start
    assert run.error_norm[-1] < 0.1 * run.error_norm[0]


def test_the_first_torque_does_not_jump_to_a_limit(run):
    assert (np.abs(run.tau[0]) < run.arm.effort_limit).all()


class TestTimeDelayEstimation:
    def test_the_default_inertia_settles_in_one_tick_where_it_is_fastest(self, arm):
        share = 0.4
        inertia = settling_inertia(arm, share)
        eigenvalues = np.linalg.eigvals(
            share * np.linalg.solve(arm.mass_matrix(arm.neutral), np.diag(inertia))
        )
        assert eigenvalues.real.max() == pytest.approx(1.0)
        assert eigenvalues.real.min() > 0.0

    def test_the_default_inertia_shows_among_the_gains(self, arm, make):
        controller = make(TDEFONTSM, arm)
        share = 1.0 - np.exp(-controller.gains.filter_rate * controller.dt)
        np.testing.assert_allclose(controller.gains.inertia, settling_inertia(arm, share))

    def test_an_inertia_far_too_large_is_unstable(self, arms, make):
        """What the default rule guards against: one number for every joint."""
        arm = arms["panda"]
        rec = simulate(arm, make(TDEFONTSM, arm, inertia=1.0), Hold(arm), 1.0)
        assert rec.error_norm[-200:].max() > 0.1
        ruled = simulate(arm, make(TDEFONTSM, arm), Hold(arm), 1.0)
        assert ruled.error_norm[-200:].max() < 0.1


def test_known_and_estimated_bounds_agree_while_the_estimates_rest(arm, make, wander):
    """[22] is [21] with other numbers in the place of `B0, B1`."""
    known = make(FONFTSM, arm, B0=3.0, B1=0.5)
    resting = make(
        AdaptiveFONFTSM, arm, B0_start=3.0, B1_start=0.5, adaptation="dead_zone", dead_zone=1e9
    )
    for row in wander(arm, 40):
        np.testing.assert_array_equal(known.update(*row), resting.update(*row))
