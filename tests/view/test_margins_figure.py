"""The figure of a loop's margins: what it draws are the loop's own numbers."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis.loop_curves import growth_rates, return_ratio
from fotsmc_pin.view import margins_figure


@pytest.fixture(scope="module")
def pid():
    return fp.margins(fp.ComputedTorque(fp.load_arm("two_link"), 1e-3, preset="pid"))


def test_the_panels_have_units_and_the_stable_range(pid):
    arm = fp.load_arm("two_link")
    ratios = fp.inertia_ratios(fp.perturb(arm, mass_scale=1.5), arm)
    nyquist, sensitivity, growth = margins_figure({"PID": pid}, {"heavier": ratios}).axes
    assert "[rad/s]" in sensitivity.get_xlabel()
    assert "[1/s]" in growth.get_ylabel()
    assert f"{pid.highest:.3g}" in growth.get_title()
    assert any("heavier" in text.get_text() for text in growth.texts)
    drawn = sensitivity.lines[0].get_ydata()
    assert drawn.max() == pytest.approx(pid.sensitivity, rel=0.02)
    assert nyquist.get_aspect() == 1.0


def test_growth_changes_its_sign_at_the_edges(pid):
    edges = np.array([pid.lowest, pid.highest])
    inside = growth_rates(pid, edges * [1.02, 0.98])
    outside = growth_rates(pid, edges * [0.98, 1.02])
    assert (inside < 0.0).all()
    assert (outside > 0.0).all()


def test_the_return_ratio_of_a_pid_is_that_of_the_textbook(pid):
    rate = np.array([20.0])
    s, late = 1j * rate, 1.5e-3  # The hold counts as half a tick.
    law = 30.0 * s + 300.0 + 1000.0 / s
    np.testing.assert_allclose(
        return_ratio(pid, rate)[0], law / s**2 * np.exp(-s * late), rtol=0.03
    )
