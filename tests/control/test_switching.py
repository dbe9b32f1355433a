"""The switching functions stand for the sign: odd, rising, within ±1, and the sign far out."""

import numpy as np
import pytest

from fotsmc_pin.control.functions import SWITCHING, sig, switch

PHI = 0.2


@pytest.mark.parametrize("kind", range(len(SWITCHING)), ids=SWITCHING)
class TestEverySwitchingFunction:
    def test_is_odd_and_zero_at_zero(self, kind):
        assert switch(0.0, kind, PHI) == 0.0
        for s in np.geomspace(1e-6, 1e6, 25):
            assert switch(-s, kind, PHI) == -switch(s, kind, PHI)

    def test_rises_and_stays_within_one(self, kind):
        values = np.array([switch(s, kind, PHI) for s in np.linspace(-1.0, 1.0, 401)])
        assert (np.diff(values) >= 0.0).all()
        assert np.abs(values).max() <= 1.0

    def test_is_the_sign_far_outside_the_layer(self, kind):
        assert switch(50 * PHI, kind, PHI) == 1.0

    def test_goes_to_the_sign_with_the_layer(self, kind):
        assert switch(1e-3, kind, 1e-6) == 1.0


def test_inside_the_layer_each_is_what_its_name_says():
    sign, saturation, tanh, power = (switch(0.05, kind, PHI) for kind in range(4))
    assert sign == 1.0
    assert saturation == pytest.approx(0.25)
    assert tanh == pytest.approx(np.tanh(0.25))
    assert power == pytest.approx(0.5)


@pytest.mark.parametrize("x", [-2.0, -1e-9, 0.0, 3.0])
@pytest.mark.parametrize("power", [0.5, 1.0, 1.7])
def test_sig(x, power):
    assert sig(x, power) == pytest.approx(np.abs(x) ** power * np.sign(x))
