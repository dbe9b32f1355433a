"""The two-link case: its formulas, and the numbers that an independent implementation gave."""

import math

import numpy as np
import pytest

from fotsmc_pin.analysis import summarize
from fotsmc_pin.paper import two_link


@pytest.fixture(scope="module")
def paper_run():
    return two_link.run()


def test_reference_derivatives_are_exact():
    h = 1e-5
    for t in np.linspace(0.1, 9.0, 30):
        before, now, after = (two_link.reference(t + step) for step in (-h, 0.0, h))
        np.testing.assert_allclose((after[0] - before[0]) / (2 * h), now[1], atol=1e-9)
        np.testing.assert_allclose((after[1] - before[1]) / (2 * h), now[2], atol=1e-8)


def test_reference_starts_at_rest_where_the_paper_says():
    q_d, v_d, _ = two_link.reference(0.0)
    np.testing.assert_allclose(q_d, [1.25 - 1.4 + 0.35, 1.25 + 1.0 - 0.25])
    np.testing.assert_allclose(v_d, 0.0, atol=1e-15)


def test_disturbance_is_the_printed_one():
    t = 1.2345
    hum = 0.5 * math.sin(200 * math.pi * t)
    expected = [2 * math.sin(t) + hum, math.cos(2 * t) + hum]
    np.testing.assert_allclose(two_link.disturbance(t), expected, rtol=1e-14)


def test_settles_to_10_mrad_as_an_independent_implementation_did(paper_run):
    assert summarize(paper_run).settling_time <= 1.05


def test_peak_torque_is_that_of_an_independent_implementation(paper_run):
    assert 340.0 <= summarize(paper_run).peak_torque <= 380.0


def test_error_left_over_is_that_of_an_independent_implementation(paper_run):
    assert 3e-4 <= summarize(paper_run).tail_rms_error <= 8e-4


def test_no_torque_is_clipped(paper_run):
    assert summarize(paper_run).saturation_fraction == 0.0


def test_substeps_change_nothing_that_matters(paper_run):
    fine, coarse = summarize(paper_run), summarize(two_link.run(substeps=2))
    assert coarse.settling_time == pytest.approx(fine.settling_time, abs=0.02)
    assert coarse.tail_rms_error == pytest.approx(fine.tail_rms_error, rel=0.1)


def test_heavier_elbow_of_the_literature_has_three_times_the_mass():
    printed, literature = two_link.true_arm(), two_link.true_arm("literature")
    difference = printed.gravity(np.zeros(2))[1] * 3.0
    assert literature.gravity(np.zeros(2))[1] == pytest.approx(difference, rel=1e-12)
