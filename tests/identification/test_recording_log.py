"""Recordings of this library as logs, and logs as CSV files: the whole path in simulation."""

from dataclasses import replace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import LogError
from fotsmc_pin.identification.log import Log
from fotsmc_pin.identification.reading import read_logs
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import Chain, Encoder, TorqueSensor


def recorded(arm, sensor=None, duration=0.3, **options):
    reference = Sinusoid.inside_limits(arm)
    controller = fp.ComputedTorque(arm, 1e-3)
    return fp.simulate(arm, controller, reference, duration, sensor=sensor, **options)


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("kinova")


@pytest.fixture(scope="module")
def measured(arm):
    return recorded(arm, Chain(Encoder(arm, 1e-3, bits=20), TorqueSensor(arm, noise=0.1)))


def test_what_sensors_read_is_the_log(measured, arm, tmp_path):
    measured.save(tmp_path / "run.npz")
    log = fp.read_log(tmp_path / "run.npz", arm)
    np.testing.assert_allclose(log.q, measured.q_measured, atol=1e-12)
    np.testing.assert_array_equal(log.v, measured.v_measured)
    np.testing.assert_array_equal(log.tau, measured.tau_measured)
    assert (log.torque, log.compensates) == ("measured", ())


def test_without_sensors_it_is_what_was_true(arm, tmp_path):
    rec = recorded(arm)
    rec.save(tmp_path / "run.npz")
    log = fp.read_log(tmp_path / "run.npz", arm)
    np.testing.assert_allclose(log.q, rec.q, atol=1e-12)
    np.testing.assert_array_equal(log.tau, rec.tau)
    assert log.torque == "commanded"


def test_a_log_survives_its_csv_file(measured, arm, tmp_path):
    measured.save(tmp_path / "run.npz")
    log = fp.read_log(tmp_path / "run.npz", arm)
    log.to_csv(tmp_path / "log.csv", arm)
    again = fp.read_log(tmp_path / "log.csv", arm)
    for name in ("t", "q", "v", "tau"):
        np.testing.assert_allclose(getattr(again, name), getattr(log, name), atol=1e-9)
    assert (again.torque, again.compensates) == (log.torque, log.compensates)


def test_jitter_is_resampled_across_continuous_joints(arm, tmp_path):
    rec = recorded(arm, jitter=0.2)
    rec.save(tmp_path / "run.npz")
    log = fp.read_log(tmp_path / "run.npz", arm)
    assert any("resampled" in note for note in log.notes)
    np.testing.assert_allclose(np.diff(log.t), np.diff(log.t)[0], rtol=1e-6)
    for k in (50, 200):
        q_d, _, _ = Sinusoid.inside_limits(arm)(log.t[k])
        np.testing.assert_allclose(arm.difference(q_d, log.q[k]), 0.0, atol=1e-3)


def test_an_arm_with_other_joints_is_refused(measured, tmp_path):
    measured.save(tmp_path / "run.npz")
    with pytest.raises(LogError, match="no position of panda_joint1"):
        fp.read_log(tmp_path / "run.npz", fp.load_arm("panda"))


@pytest.mark.parametrize("words", [("gravity",), ("gravity", "coriolis"), ("coriolis", "friction")])
def test_what_a_robot_adds_is_known_from_its_run(arm, words):
    """Of a run on a robot the torque that was sent is the log's, and the sum is the total again."""
    rec = recorded(arm, duration=1.2)
    added = np.zeros_like(rec.tau)
    for k, (q, v) in enumerate(zip(rec.q, rec.v, strict=True)):
        weight = arm.gravity(q)
        added[k] += weight * ("gravity" in words)
        whole = arm.inverse_dynamics(q, v, np.zeros(arm.nv))
        added[k] += (whole - weight) * ("coriolis" in words)
    told = {"compensates": list(words)}
    rec = replace(rec, metadata=rec.metadata | told, signals={"sent": rec.tau - added})
    log = Log.from_recording(rec)
    assert (log.torque, log.compensates) == ("commanded", words)
    np.testing.assert_array_equal(log.tau, rec.signals["sent"])
    total = replace(log, tau=rec.tau, compensates=())
    (one,), (other,) = (read_logs(arm, [each])[0].pieces for each in (log, total))
    np.testing.assert_allclose(one.raw_tau, other.raw_tau, atol=1e-9)
    felt = Log.from_recording(replace(rec, tau_measured=rec.tau))
    assert felt.torque == "measured"
    assert felt.compensates == tuple(word for word in words if word == "friction")
