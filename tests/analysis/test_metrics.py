"""Metrics of signals whose metrics are known."""

from dataclasses import fields

import numpy as np
import pytest

from fotsmc_pin.analysis import Summary, settling_time, summarize
from fotsmc_pin.analysis.metrics import UNITS
from fotsmc_pin.arms import load_arm
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.simulation import Recording

DT, DURATION = 1e-3, 10.0


@pytest.fixture(scope="module")
def arm():
    return load_arm("two_link", effort_limit=[50.0, 20.0])


@pytest.fixture
def record(arm):
    """Builds a recording from the error, the torque and the speed of both joints."""
    t = DT * np.arange(round(DURATION / DT) + 1)

    def build(e=lambda t: 0 * t, tau=lambda t: 0 * t, v=lambda t: 0 * t, other=lambda t: 0 * t):
        zero = np.zeros((len(t), 2))
        return Recording(
            t=t,
            q=zero,
            v=np.column_stack([v(t), 0 * t]),
            q_d=zero,
            v_d=zero,
            e=np.column_stack([e(t), other(t)]),
            e_dot=zero,
            tau=np.column_stack([tau(t), 0 * t]),
            signals={},
            arm=arm,
        )

    return build


def test_an_exponential_error_has_the_closed_forms_of_its_integrals(record):
    s = summarize(record(e=lambda t: 0.5 * np.exp(-2.0 * t)))
    end = np.exp(-2.0 * DURATION)
    assert s.iae == pytest.approx(0.25 * (1 - end), rel=1e-5)
    assert s.ise == pytest.approx(0.0625, rel=1e-5)
    assert s.itae == pytest.approx(0.5 / 4.0, rel=1e-5)
    assert s.max_error == 0.5
    assert s.max_tail_error == pytest.approx(0.5 * np.exp(-10.0))
    assert s.rms_error == pytest.approx(np.sqrt(0.0625 / DURATION), rel=1e-3)
    for bound, found in (
        (1e-2, s.settling_time),
        (1e-3, s.settling_time_1_mrad),
        (1e-4, s.settling_time_0_1_mrad),
    ):
        exact = np.log(0.5 / bound) / 2.0
        assert exact <= found < exact + 1.01 * DT


def test_the_norm_runs_over_the_joints(record):
    s = summarize(record(e=lambda t: 0.03 + 0 * t, other=lambda t: -0.04 + 0 * t))
    assert s.max_error == pytest.approx(0.05)
    assert s.rms_error == pytest.approx(0.05)
    assert s.tail_rms_error == pytest.approx(0.05)


def test_settling_counts_the_last_return_and_inf_where_there_is_none(record):
    late = record(e=lambda t: np.where((t < 1.0) | (np.abs(t - 6.0) < 0.1), 1.0, 0.0))
    assert summarize(late).settling_time == pytest.approx(6.1, abs=2 * DT)
    assert summarize(record(e=lambda t: 0.02 + 0 * t)).settling_time == np.inf
    assert summarize(record(e=lambda t: np.where(t < 9.9995, 0.0, 1.0))).settling_time == np.inf
    assert summarize(record()).settling_time == 0.0


def test_settling_to_a_bound_of_ones_own(record):
    rec = record(e=lambda t: np.exp(-t))
    assert settling_time(rec, np.exp(-3.0)) == pytest.approx(3.0, abs=2 * DT)
    with pytest.raises(ArgumentError, match="bound"):
        settling_time(rec, 0.0)


def test_a_sine_of_torque_has_four_amplitudes_of_variation_per_period(record):
    s = summarize(record(tau=lambda t: 7.0 * np.sin(2 * np.pi * 2.0 * t)))
    assert s.torque_variation == pytest.approx(4 * 7.0 * 2.0, rel=1e-3)
    assert s.tail_torque_variation == pytest.approx(4 * 7.0 * 2.0, rel=1e-3)
    assert s.peak_torque == pytest.approx(7.0)
    assert s.rms_torque == pytest.approx(7.0 / np.sqrt(2), rel=1e-3)


def test_a_sign_that_switches_every_tick_varies_by_twice_its_size(record):
    s = summarize(record(tau=lambda t: 3.0 * (-1.0) ** np.round(t / DT)))
    assert s.torque_variation == pytest.approx(6.0 / DT)
    assert s.chattering == pytest.approx(1.0, abs=1e-6)


def test_chattering_is_the_share_of_power_above_20_hz(record):
    """Amplitudes 2 at 3 Hz and 1 at 100 Hz: a fifth of the power."""
    s = summarize(
        record(
            tau=lambda t: 9.0 + 2.0 * np.sin(2 * np.pi * 3.0 * t) + np.sin(2 * np.pi * 100.0 * t)
        )
    )
    assert s.chattering == pytest.approx(0.2, rel=1e-2)
    assert summarize(record(tau=lambda t: 5.0 + 0 * t)).chattering == 0.0


def test_energy_counts_work_done_and_absorbed(record):
    s = summarize(record(tau=lambda t: 2.0 + 0 * t, v=lambda t: np.where(t < 5.0, 1.0, -1.0)))
    assert s.energy == pytest.approx(2.0 * DURATION, rel=1e-3)


def test_saturation_is_the_share_of_ticks_with_a_joint_at_its_limit(record):
    s = summarize(record(tau=lambda t: np.where(t < 2.5, -50.0, 49.0)))
    assert s.saturation_fraction == pytest.approx(0.25, abs=1e-3)


METRICS = [field.name for field in fields(Summary) if field.name != "position_unit"]


def test_every_metric_has_the_unit_of_its_definition():
    assert [*UNITS] == METRICS
    words = " " + " ".join(Summary.__doc__.split("Attributes:")[1].split())
    for name, unit in UNITS.items():
        definition = words.split(f" {name}: ", 1)[1].split(". ")[0]
        assert f"[{unit}]" in definition or unit == "–", name


def test_every_metric_is_defined_and_a_plain_number(record):
    summary = summarize(record())
    for name in METRICS:
        assert f"        {name}: " in Summary.__doc__
        assert isinstance(getattr(summary, name), float)
    assert summary.duration == DURATION
    assert summary.as_dict().keys() == set(METRICS)
