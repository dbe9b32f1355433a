"""What sensors read is recorded beside what is true: position, velocity, and torque."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, RecordingError
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import (
    Chain,
    Encoder,
    NoisySensor,
    QuantizedSensor,
    TorqueSensor,
    simulate,
)

READINGS = ("q_measured", "v_measured", "tau_measured")
DT = 1e-3


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


def run(arm, sensor=None, duration=0.5, **options):
    controller = fp.ComputedTorque(arm, DT)
    reference = Sinusoid.inside_limits(arm)
    return simulate(arm, controller, reference, duration, sensor=sensor, **options)


def test_without_sensors_nothing_is_read(arm):
    rec = run(arm, duration=0.01)
    assert [getattr(rec, name) for name in READINGS] == [None, None, None]


def test_the_readings_are_those_that_the_controller_was_given(arm):
    class Spy(fp.ComputedTorque):
        def update(self, q, v, *rest, **options):
            self.given.append((q, v))
            return super().update(q, v, *rest, **options)

    controller = Spy(arm, DT)
    controller.given = []
    sensor = NoisySensor(arm, position=1e-4, velocity=1e-2)
    rec = simulate(arm, controller, Sinusoid.inside_limits(arm), 0.1, sensor=sensor)
    np.testing.assert_array_equal(rec.q_measured, [q for q, _ in controller.given])
    np.testing.assert_array_equal(rec.v_measured, [v for _, v in controller.given])
    assert rec.tau_measured is None
    assert 0.5e-4 < (rec.q_measured - rec.q).std() < 2e-4


def test_torque_is_read_with_the_noise_and_the_steps_of_the_sensor(arm):
    noise, step = np.array([2.0, 0.5]), np.array([0.25, 0.0])
    rec = run(arm, TorqueSensor(arm, noise=noise, step=step, seed=4), duration=2.0)
    off = rec.tau_measured - rec.tau
    np.testing.assert_allclose(off.std(axis=0), noise, rtol=0.06)
    assert np.all(np.abs(off.mean(axis=0)) < 4.0 * noise / np.sqrt(len(rec)))
    np.testing.assert_allclose(rec.tau_measured[:, 0] % 0.25 % 0.25, 0.0, atol=1e-12)
    assert np.unique(rec.tau_measured[:, 1]).size == len(rec)


def test_an_exact_sensor_reads_the_torque_of_its_row(arm):
    rec = run(arm, TorqueSensor(arm), duration=0.05)
    np.testing.assert_array_equal(rec.tau_measured, rec.tau)


def test_reading_torque_changes_nothing_else_in_a_run(arm):
    plain = run(arm, NoisySensor(arm, position=1e-5))
    chain = Chain(NoisySensor(arm, position=1e-5), TorqueSensor(arm, noise=1.0, seed=0))
    rec = run(arm, chain)
    for name in ("q", "v", "tau", "q_measured", "v_measured"):
        np.testing.assert_array_equal(getattr(rec, name), getattr(plain, name))
    np.testing.assert_array_equal(run(arm, chain).tau_measured, rec.tau_measured)


def test_chains_read_torque_part_after_part(arm):
    inner = Chain(Encoder(arm, DT, bits=20), TorqueSensor(arm, noise=1.0))
    rec = run(arm, Chain(inner, TorqueSensor(arm, step=0.5)), duration=0.05)
    np.testing.assert_allclose(rec.tau_measured % 0.5 % 0.5, 0.0, atol=1e-12)
    assert not np.array_equal(rec.tau_measured, np.round(2.0 * rec.tau) / 2.0)


def test_rows_that_are_skipped_skip_their_readings(arm):
    sensor = TorqueSensor(arm, noise=1.0)
    every, third = run(arm, sensor, 0.1), run(arm, sensor, 0.1, record_every=3)
    for name in READINGS:
        np.testing.assert_array_equal(getattr(third, name), getattr(every, name)[::3])


def test_readings_of_continuous_joints_have_the_shape_of_a_configuration(arms):
    arm = arms["kinova"]
    rec = run(arm, QuantizedSensor(arm, position=1e-3), duration=0.01)
    assert rec.q_measured.shape == (11, arm.nq)
    assert rec.v_measured.shape == (11, arm.nv)


def test_readings_survive_the_file(arm, tmp_path):
    rec = run(arm, Chain(NoisySensor(arm, position=1e-5), TorqueSensor(arm, noise=1.0)), 0.05)
    rec.save(tmp_path / "run.npz")
    again = fp.Recording.load(tmp_path / "run.npz")
    for name in READINGS:
        np.testing.assert_array_equal(getattr(again, name), getattr(rec, name))


def test_a_run_without_readings_has_the_file_it_always_had(arm, tmp_path):
    run(arm, duration=0.01).save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        assert not set(READINGS) & set(file.files)
    again = fp.Recording.load(tmp_path / "run.npz")
    assert [getattr(again, name) for name in READINGS] == [None, None, None]


def test_a_file_that_lost_a_needed_array_is_still_refused(arm, tmp_path):
    run(arm, duration=0.01).save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        kept = {name: file[name] for name in file.files if name != "tau"}
    np.savez(tmp_path / "less.npz", **kept)
    with pytest.raises(RecordingError, match="tau"):
        fp.Recording.load(tmp_path / "less.npz")


@pytest.mark.parametrize("reading", [np.zeros(1), 0.0, None, "much"])
def test_a_torque_sensor_that_returns_nonsense_is_named(arm, reading):
    sensor = TorqueSensor(arm)
    sensor.measure_torque = lambda t, tau: tau.copy() if t < 0.05 else reading
    with pytest.raises(ArgumentError, match=r"^sensor torque = .*at t = 0\.05"):
        run(arm, sensor)


@pytest.mark.parametrize("options", [{"noise": -1.0}, {"step": [1.0, -1.0]}, {"seed": -1}])
def test_a_torque_sensor_refuses_what_it_cannot_be(arm, options):
    with pytest.raises(ArgumentError, match=next(iter(options))):
        TorqueSensor(arm, **options)
