"""How the estimates `B̂0, B̂1` move: the printed law, and the practical ones beside it."""

import numpy as np
import pytest

from fotsmc_pin.arms import perturb
from fotsmc_pin.control import AdaptiveFONFTSM
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import simulate

DT = 1e-3
START = np.array([5.0, 5.0])


def estimates(controller, rows):
    """`B̂` after each tick, and `S` of each tick."""
    b, S = [], []
    for row in rows:
        controller.update(*row)
        b.append(controller.signals["b_hat"])
        S.append(controller.signals["s"])
    return np.array(b), np.array(S)


@pytest.fixture
def arm(arms):
    return arms["two_link"]


@pytest.fixture
def adaptive(arm, make):
    """With the paper's gains and torques that are never clipped."""

    def with_gains(**gains):
        controller = make(AdaptiveFONFTSM, arm, "paper", **gains)
        controller.joints.effort_limit[:] = np.inf
        return controller

    return with_gains


def test_the_printed_law_is_23_and_24(adaptive, arm, wander):
    rows = list(wander(arm, 200))
    b, S = estimates(adaptive(), rows)
    speed = np.array([np.linalg.norm(row[1]) for row in rows])
    norm = np.linalg.norm(S, axis=1)
    rates = np.column_stack([norm, norm * speed]) / 0.05
    np.testing.assert_allclose(b, START + DT * np.cumsum(rates, axis=0), rtol=1e-12)


def test_the_direct_reading_of_upsilon_is_400_times_slower(adaptive, arm, wander):
    inverse, _ = estimates(adaptive(), wander(arm, 100))
    direct, _ = estimates(adaptive(adaptation_rate="direct"), wander(arm, 100))
    np.testing.assert_allclose(400.0 * (direct - START), inverse - START, atol=1e-11)


def test_the_printed_law_never_falls(adaptive, arm, wander):
    b, _ = estimates(adaptive(), wander(arm, 500))
    assert (np.diff(b, axis=0) >= 0.0).all()
    assert (b[-1] > START + 0.1).all()


def test_the_dead_zone_rests_while_the_surface_is_near(adaptive, arm, wander):
    rows = list(wander(arm, 300))
    _, S = estimates(adaptive(), rows)
    norm = np.linalg.norm(S, axis=1)
    threshold = float(np.median(norm))
    b, _ = estimates(adaptive(adaptation="dead_zone", dead_zone=threshold), rows)
    moved = np.diff(np.vstack([START, b]), axis=0)[:, 0] > 0.0
    np.testing.assert_array_equal(moved, norm >= threshold)


def test_leakage_forgets_at_its_rate(adaptive, arm, wander):
    controller = adaptive(adaptation="leakage", leakage=4.0, tempering=500.0)
    estimates(controller, wander(arm, 300))
    grown = controller.signals["b_hat"] - START
    assert (grown > 0.05).all()
    # Tempering has emptied D^α after 0.2 s, so that S is zero and only the leak is left.
    q, rest = arm.neutral, np.zeros(arm.nv)
    still = [(q, rest, q, rest, rest)] * 200
    estimates(controller, still)
    before = controller.signals["b_hat"] - START
    estimates(controller, still)
    np.testing.assert_allclose(
        controller.signals["b_hat"] - START, before * np.exp(-4.0 * 0.2), rtol=1e-6
    )


@pytest.mark.parametrize("adaptation", ["projection", "leakage"])
def test_projection_and_leakage_hold_the_estimates(adaptive, arm, wander, adaptation):
    b, _ = estimates(adaptive(adaptation=adaptation, largest_bound=5.2), wander(arm, 500))
    assert (b <= 5.2).all()
    assert b.max() == 5.2


def test_estimates_rest_while_a_torque_is_clipped(arm, make, wander):
    controller = make(AdaptiveFONFTSM, arm, "paper")
    controller.joints.effort_limit[:] = 1e-3
    b, S = estimates(controller, wander(arm, 100))
    assert np.linalg.norm(S, axis=1).max() > 0.1
    np.testing.assert_array_equal(b, np.tile(START, (100, 1)))


@pytest.fixture(scope="module")
def heavier_panda(arms_of_module):
    arm = arms_of_module["panda"]
    return arm, perturb(arm, mass_scale=1.1)


@pytest.fixture(scope="module")
def arms_of_module(arms):
    return arms


@pytest.fixture(scope="module")
def runs(heavier_panda):
    """The practical preset, and the same with its estimates held, on a Panda 10 % too heavy."""
    arm, true = heavier_panda
    reference = Sinusoid.inside_limits(arm)
    start = arm.integrate(reference(0.0)[0], np.full(arm.nv, 0.1))

    def run(**gains):
        controller = AdaptiveFONFTSM(arm, DT, preset="practical", **gains)
        return simulate(true, controller, reference, 4.0, q0=start)

    return run(), run(upsilon_0=1e9, upsilon_1=1e9)


def test_the_practical_preset_tracks_a_wrong_model_within_the_limits(runs):
    rec, _ = runs
    assert tail_rms(rec) < 2e-3
    assert (np.abs(rec.tau) < rec.arm.effort_limit).all()


def test_the_practical_adaptation_earns_its_keep(runs):
    rec, held = runs
    assert tail_rms(rec) < 0.8 * tail_rms(held)
    b = rec.signals["b_hat"]
    assert b[:, 0].max() > 1.5 * b[0, 0], "it rises while the error is large"
    assert b[-1, 0] < 0.6 * b[:, 0].max(), "and forgets afterwards"


def tail_rms(rec):
    tail = rec.error_norm[rec.t >= 2.0]
    return np.sqrt(np.mean(tail**2))
