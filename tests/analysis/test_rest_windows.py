"""Metrics of rest, against made-up runs whose values are known."""

import math

import numpy as np
import pytest

from fotsmc_pin.analysis.rest_windows import arrival_time, overshoot, swing_in
from fotsmc_pin.errors import ArgumentError

T = np.arange(0.0, 4.0 + 1e-9, 1e-3)
"""Four seconds at 1 kHz."""


class TestSwing:
    def test_it_is_peak_to_peak_of_each_joint_in_the_window_alone(self):
        e = np.column_stack([2e-3 * np.sin(2 * np.pi * T) + 5.0, np.where(T < 1.0, 9.0, 0.5)])
        np.testing.assert_allclose(swing_in(T, e, (2.0, 4.0)), [4e-3, 0.0], atol=1e-12)

    def test_a_window_beyond_the_run_is_refused(self):
        with pytest.raises(ArgumentError, match="from 0 to 4 s"):
            swing_in(T, np.zeros((T.size, 1)), (5.0, 6.0))


class TestArrivalTime:
    def test_it_counts_from_the_window_to_when_the_last_joint_arrives(self):
        e = 1e-2 * np.exp(-np.outer(T, [10.0, 5.0]))
        v = np.zeros_like(e)
        # e^{-5 t} = 0.1 at 0.4605 s; the window begins 0.1 s after.
        assert arrival_time(T, e, v, (0.1, 4.0)) == pytest.approx(0.361, abs=1.1e-3)

    def test_speed_counts_too(self):
        e = np.zeros((T.size, 1))
        v = np.where(T < 1.5, 3e-3, 0.0)[:, None]
        assert arrival_time(T, e, v, (1.0, 4.0)) == pytest.approx(0.5)
        assert arrival_time(T, e, v, (1.0, 4.0), speed=4e-3) == 0.0

    def test_what_stirs_again_has_not_come_to_rest(self):
        e = np.zeros((T.size, 1))
        e[-1] = 2e-3
        assert arrival_time(T, e, 0.0 * e, (0.0, 4.0)) == math.inf
        assert arrival_time(T, e, 0.0 * e, (0.0, 3.9)) == 0.0

    def test_a_pause_at_the_end_is_no_rest(self):
        e = np.where(T < 3.6, 2e-3, 0.0)[:, None]
        assert arrival_time(T, e, 0.0 * e, (0.0, 4.0)) == math.inf
        assert arrival_time(T, e, 0.0 * e, (0.0, 4.0), calm=0.3) == pytest.approx(3.6)

    def test_bounds_are_above_zero(self):
        with pytest.raises(ArgumentError, match="error"):
            arrival_time(T, T[:, None], T[:, None], (0.0, 1.0), error=0.0)


class TestOvershoot:
    def test_it_is_what_lies_beyond_the_end_on_either_way(self):
        move = 1.0 - np.exp(-8.0 * T) * np.cos(20.0 * T)
        to_go = np.column_stack([1.0 - move, move - 1.0])
        expected = np.exp(-8.0 * T) * -np.cos(20.0 * T)
        np.testing.assert_allclose(overshoot(T, to_go, (0.0, 4.0)), expected.max(), atol=1e-12)

    def test_coming_short_is_no_overshoot(self):
        to_go = np.exp(-T)[:, None]
        np.testing.assert_array_equal(overshoot(T, to_go, (0.0, 4.0)), 0.0)

    def test_a_joint_with_nowhere_to_go_overshoots_either_way(self):
        to_go = np.where(T > 1.0, -1e-3, 0.0)[:, None]
        np.testing.assert_allclose(overshoot(T, to_go, (0.0, 4.0)), 1e-3)
