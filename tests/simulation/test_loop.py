"""The loop: what it calls and when, what it records, and what it refuses."""

import pickle

import numpy as np
import pytest

from fotsmc_pin.control import ComputedTorque, LinearSMC
from fotsmc_pin.errors import ArgumentError, DivergenceError
from fotsmc_pin.references import Hold, Sinusoid
from fotsmc_pin.simulation import simulate


@pytest.fixture
def two_link(arms):
    return arms["two_link"]


def test_rows_are_the_ticks_from_zero_to_the_duration(two_link):
    controller = LinearSMC(two_link, 2e-3)
    rec = simulate(two_link, controller, Hold(two_link), 0.1)
    np.testing.assert_allclose(rec.t, 2e-3 * np.arange(51))
    assert rec.signals["s"].shape == rec.tau.shape == (51, 2)
    sparse = simulate(two_link, controller, Hold(two_link), 0.1, record_every=10)
    for name in ("t", "q", "v", "q_d", "v_d", "e", "e_dot", "tau"):
        np.testing.assert_array_equal(getattr(sparse, name), getattr(rec, name)[::10])
    np.testing.assert_array_equal(sparse.signals["s"], rec.signals["s"][::10])


def test_a_run_starts_on_the_reference_or_where_it_is_told(arm):
    reference = Sinusoid.inside_limits(arm, ramp=0.0)
    q_d, v_d, _ = reference(0.0)
    rec = simulate(arm, ComputedTorque(arm, 1e-3), reference, 0.002)
    np.testing.assert_array_equal(rec.q[0], q_d)
    np.testing.assert_array_equal(rec.v[0], v_d)
    elsewhere = arm.integrate(q_d, np.full(arm.nv, 0.1))
    rec = simulate(
        arm, ComputedTorque(arm, 1e-3), reference, 0.002, q0=elsewhere, v0=np.zeros(arm.nv)
    )
    np.testing.assert_allclose(rec.e[0], 0.1, atol=1e-12)
    np.testing.assert_allclose(rec.e_dot[0], -v_d)


def test_the_same_run_twice_is_the_same_bit_for_bit(arm):
    controller = LinearSMC(arm, 1e-3)
    one, two = (simulate(arm, controller, Sinusoid.inside_limits(arm), 0.05) for _ in range(2))
    for name in ("q", "v", "tau", "e"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))


def test_controller_sensor_and_actuator_are_reset_at_the_start(two_link, held):
    class Part:
        resets = 0

        def reset(self):
            self.resets += 1

    class Sensor(Part):
        def __call__(self, t, q, v):
            return q, v

    class Actuator(Part):
        def __call__(self, t, tau):
            return tau

    parts = held(two_link, 1e-3), Sensor(), Actuator()
    controller, sensor, actuator = parts
    for runs in (1, 2):
        simulate(two_link, controller, Hold(two_link), 0.01, sensor=sensor, actuator=actuator)
        assert [part.resets for part in parts] == [runs] * 3


def test_the_controller_sees_the_sensor_and_the_plant_the_actuator(two_link, held):
    seen = []

    def remember(q, v):
        seen.append(v.copy())
        return [1.0, 1.0]

    rec = simulate(
        two_link,
        held(two_link, 1e-3, remember),
        Hold(two_link),
        0.003,
        sensor=lambda t, q, v: (q, v + 7.0),
        actuator=lambda t, tau: tau * (1.0 + t),
    )
    np.testing.assert_allclose(seen, rec.v + 7.0)
    np.testing.assert_allclose(rec.tau[:, 0], 1.0 + rec.t)


def test_progress_is_told_from_zero_to_one(two_link, held):
    told = []
    simulate(two_link, held(two_link, 1e-3), Hold(two_link), 1.0, progress=told.append)
    assert told[0] == 0.0
    assert told[-1] == 1.0
    assert told == sorted(told)


class TestDivergence:
    @pytest.fixture
    def error(self, two_link, held):
        runaway = held(two_link, 1e-3, lambda q, v: [0.0, 100.0 * (1.0 + abs(v[1]))])
        with pytest.raises(DivergenceError) as caught:
            simulate(two_link, runaway, Hold(two_link), 5.0)
        return caught.value

    def test_names_the_joint_and_the_time(self, error, two_link):
        assert error.joint == two_link.joint_names[1]
        assert 0.0 < error.time < 5.0
        assert error.joint in str(error)
        assert "substeps" in str(error)

    def test_carries_what_was_recorded(self, error):
        rec = error.recording
        assert rec.t[-1] == pytest.approx(error.time - 1e-3)
        assert np.isfinite(rec.q).all()
        assert np.isfinite(rec.v).all()

    def test_crosses_process_borders(self, error):
        again = pickle.loads(pickle.dumps(error))
        assert (again.joint, again.time, str(again)) == (error.joint, error.time, str(error))
        np.testing.assert_array_equal(again.recording.q, error.recording.q)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"duration": 0.0}, "duration"),
        ({"duration": np.nan}, "duration"),
        ({"q0": [0.0]}, "q0"),
        ({"v0": [0.0, np.inf]}, "v0"),
        ({"substeps": 0}, "substeps"),
        ({"substeps": 1.5}, "substeps"),
        ({"record_every": 0}, "record_every"),
        ({"integrator": "euler"}, "integrator"),
        ({"disturbance": lambda t: [1.0, 2.0, 3.0]}, "disturbance"),
        ({"reference": lambda t: (np.zeros(2), np.zeros(2))}, "reference"),
        ({"reference": lambda t: (np.zeros(3), np.zeros(2), np.zeros(2))}, "reference q_d"),
        ({"reference": 3.0}, "reference"),
    ],
)
def test_unusable_arguments_are_named(two_link, held, options, named):
    arguments = {"reference": Hold(two_link), "duration": 0.01} | options
    with pytest.raises(ArgumentError) as caught:
        simulate(two_link, held(two_link, 1e-3), **arguments)
    assert caught.value.argument == named


@pytest.mark.parametrize("dt", [0.0, -1.0, np.inf])
def test_an_unusable_tick_is_named(two_link, held, dt):
    with pytest.raises(ArgumentError, match=r"controller\.dt"):
        simulate(two_link, held(two_link, dt), Hold(two_link), 0.01)
