"""The torque rate that encoders ask for: computed as measured, and held against a limit."""

import warnings

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import TorqueRateWarning, asked_torque_rate, warn_of_torque_rate
from fotsmc_pin.control import ExactDifferentiator
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import Encoder, TickDelay

DT = 1e-3


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("ur5")


def test_it_is_the_rate_of_a_run(arm):
    law, encoder = fp.RobustFONFTSM(arm, DT), Encoder(arm, DT, bits=17)
    asked = asked_torque_rate(law, encoder)
    reference = Sinusoid.inside_limits(arm)
    rec = fp.simulate(arm, law, reference, 1.5, sensor=encoder, actuator=TickDelay(1))
    # Second differences tell noise from motion: an even rate is none of it.
    rate = np.diff(rec.tau[500:], axis=0) / DT
    trend = np.array([np.convolve(row, np.ones(50) / 50.0, mode="same") for row in rate.T]).T
    np.testing.assert_allclose(asked[:5], (rate - trend)[50:-50].std(axis=0)[:5], rtol=0.15)


def test_it_grows_with_the_steps_and_with_the_bandwidth(arm):
    law = fp.RobustFONFTSM(arm, DT)
    rates = [asked_torque_rate(law, Encoder(arm, DT, bits=bits)) for bits in (17, 18)]
    np.testing.assert_allclose(rates[0], 2.0 * rates[1], rtol=1e-12)
    slower = asked_torque_rate(fp.RobustFONFTSM(arm, DT, bandwidth=0.5), Encoder(arm, DT, bits=17))
    assert (slower < 0.7 * rates[0]).all()


@pytest.mark.parametrize(("rate", "bits", "warns"), [(900.0, 17, True), (900.0, 20, False)])
def test_a_rate_that_noise_exceeds_is_warned_of(arm, rate, bits, warns):
    guard = fp.Safeguard(fp.RobustFONFTSM(arm, DT), torque_rate=rate)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        warn_of_torque_rate(guard, Encoder(arm, DT, bits=bits))
    assert [note.category for note in told] == [TorqueRateWarning] * warns
    assert all("torque_rate = 900 N·m/s is less than twice" in str(note.message) for note in told)


def test_it_is_silent_where_nothing_can_be_said(arm):
    encoder = Encoder(arm, DT, differentiator=ExactDifferentiator(arm, DT, jerk=1e4))
    with pytest.raises(ArgumentError, match="FilteredDifferentiator"):
        asked_torque_rate(fp.RobustFONFTSM(arm, DT), encoder)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_torque_rate(fp.Safeguard(fp.RobustFONFTSM(arm, DT), torque_rate=9.0), encoder)
        warn_of_torque_rate(fp.Safeguard(fp.RobustFONFTSM(arm, DT)), Encoder(arm, DT))
        law = fp.ModelLearning(fp.RobustFONFTSM(arm, DT))
        warn_of_torque_rate(fp.Safeguard(law, torque_rate=9.0), encoder)
