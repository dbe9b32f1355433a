"""Memory does not wind up behind a clipped torque: a long saturation, and the recovery after it."""

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import (
    FONFTSM,
    AdaptiveFONFTSM,
    ComputedTorque,
    FractionalSwitchingSMC,
    LinearSMC,
    SuperTwistingSMC,
)
from fotsmc_pin.control.torque_limits import integrated, unwound
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import simulate

LIMIT, PUSH = 40.0, 39.0
PUSH_START, PUSH_END = 0.5, 2.5


def push(t):
    """With gravity, more than the elbow's motor can hold once it has given way."""
    return np.array([0.0, -PUSH if PUSH_START < t < PUSH_END else 0.0])


@pytest.fixture(scope="module")
def limited():
    return load_arm("two_link", effort_limit=LIMIT)


@pytest.fixture(scope="module")
def believed_unlimited():
    return load_arm("two_link", effort_limit=1e6)


WITH_MEMORY = [
    (FONFTSM, "paper"),
    (FONFTSM, "practical"),
    (AdaptiveFONFTSM, "paper"),
    (AdaptiveFONFTSM, "practical"),
    (SuperTwistingSMC, "sign"),
    (SuperTwistingSMC, "boundary_layer"),
    (FractionalSwitchingSMC, "sign"),
    (FractionalSwitchingSMC, "boundary_layer"),
    (ComputedTorque, "pid"),
]


def pushed(plant, controller):
    """Overshoot [rad], and time from the end of the push until the error stays below 10 mrad."""
    reference = Hold(plant, [1.2, 0.3])
    rec = simulate(plant, controller, reference, 7.5, disturbance=push, substeps=1)
    during = (rec.t > PUSH_START) & (rec.t < PUSH_END)
    limited = (np.abs(rec.tau[during]) >= LIMIT).any(axis=1).mean()
    assert limited > 0.9, "the scenario is one of long saturation"
    after = rec.t >= PUSH_END
    late = np.flatnonzero(rec.error_norm[after] > 1e-2)
    return rec.e[after, 1].max(), rec.t[after][late[-1]] - PUSH_END


@pytest.mark.parametrize(
    ("law", "preset"), WITH_MEMORY, ids=[f"{law.__name__}-{preset}" for law, preset in WITH_MEMORY]
)
def test_recovery_is_better_than_that_of_a_law_that_ignores_the_limit(
    law, preset, limited, believed_unlimited, make
):
    overshoot, time = pushed(limited, make(law, limited, preset))
    blind_overshoot, blind_time = pushed(limited, make(law, believed_unlimited, preset))
    assert overshoot < 0.6 * blind_overshoot
    assert time < 0.9 * blind_time
    assert time < 1.5


def test_a_law_without_memory_has_nothing_to_unwind(limited, believed_unlimited, make):
    aware = pushed(limited, make(LinearSMC, limited))
    assert aware == pushed(limited, make(LinearSMC, believed_unlimited))


@pytest.mark.parametrize("w", [-3.0, 0.0, 2.0])
@pytest.mark.parametrize("excess", [-1e9, -0.4, 0.0, 0.4, 1e9])
@pytest.mark.parametrize("gain", [1e-6, 0.5, 40.0])
def test_unwound_lies_between_zero_and_the_integrand(w, excess, gain):
    inside = unwound(w, excess, gain)
    assert min(w, 0.0) <= inside <= max(w, 0.0)
    if w * excess >= 0.0:
        assert inside == w, "what pulls away from the limit enters in full"
    elif abs(excess) < gain * abs(w):
        command = excess - gain * (inside - w)
        assert command == pytest.approx(0.0, abs=1e-12), "the command comes back to the limit"
    else:
        assert inside == 0.0


def test_unwound_without_a_gain_keeps_the_integrand():
    assert unwound(-3.0, 5.0, 0.0) == -3.0


@pytest.mark.parametrize(
    ("rate", "excess", "moves"),
    [(1.0, 0.0, True), (-1.0, 0.0, True), (1.0, 2.0, True), (-1.0, 2.0, False), (1.0, -2.0, False)],
)
def test_an_integral_rests_while_it_would_push_further(rate, excess, moves):
    assert integrated(5.0, rate, 0.1, excess) == (5.0 + 0.1 * rate if moves else 5.0)
