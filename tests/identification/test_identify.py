"""Identification finds plants that it does not know, and says how well."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.identification import Log
from fotsmc_pin.identification.base_parameters import base_of
from fotsmc_pin.identification.regressor import Parameters
from tests.identification import hidden

ARMS = (
    "panda",
    pytest.param("ur5", marks=pytest.mark.long),
    "kinova",
    pytest.param("z1", marks=pytest.mark.long),
    "so100",
    "two_link",
)


@cache
def found(name, seed=0):
    nominal = fp.load_arm(name)
    true = hidden.hidden_plant(nominal, seed)
    motion = hidden.swings(nominal, seed, duration=20.0)
    log = hidden.calculated(true, motion, seed, duration=20.0)
    other = hidden.calculated(
        true, hidden.swings(nominal, seed + 50, duration=10.0), seed + 1, duration=10.0
    )
    return true, log, other, fp.identify([log], nominal, validate=[other])


def theta_of(arm):
    """Return the parameters of an arm in the order of `Parameters`."""
    bodies = [body.toDynamicParameters() for body in [*arm.model.inertias][1:]]
    return np.concatenate([*bodies, arm.armature, arm.damping, arm.friction])


def second_moments(inertia):
    about = np.array(inertia.inertia)
    return np.linalg.eigvalsh(0.5 * np.trace(about) * np.eye(3) - about)


@pytest.mark.parametrize("name", ARMS)
def test_the_torque_of_another_motion_is_predicted_down_to_its_noise(name):
    true, _, _, result = found(name)
    noise = hidden.TORQUE_NOISE * hidden.drive_size(true)
    (check,) = result.validation
    assert np.all(check.error < 1.3 * noise)
    # Averages over hundredths of a second hold less of the noise, and are predicted too.
    average = np.sqrt(hidden.CALCULATED_DT / (2.0 * np.sqrt(np.pi) * 0.02))
    assert np.all(check.averaged_error < 1.3 * average * noise)
    assert np.max(check.averaged_nominal_error / check.averaged_error) > 2.0


@pytest.mark.parametrize("name", ARMS)
def test_base_parameters_are_as_far_off_as_they_say(name):
    true, _, _, result = found(name)
    base = base_of(result.nominal, Parameters(result.nominal.nv))
    truth = base.matrix @ theta_of(true)
    off = [
        (row.value - t) / row.deviation
        for row, t in zip(result.base_parameters, truth, strict=True)
    ]
    assert np.mean(np.abs(off) < 3.0) >= 0.95
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.6


@pytest.mark.parametrize("name", ARMS)
def test_every_body_can_exist(name):
    _, _, _, result = found(name)
    for body in [*result.arm.model.inertias][1:]:
        assert body.mass > 0.0
        assert np.all(second_moments(body) > 0.0)
    for values in (result.arm.armature, result.arm.damping, result.arm.friction):
        assert np.all(values >= 0.0)


def test_base_parameters_alone_decide_the_torque():
    arm = fp.load_arm("ur5")
    base = base_of(arm, Parameters(arm.nv))
    rng = np.random.default_rng(3)
    null = np.linalg.svd(base.matrix)[2][len(base.names) :]
    data = arm.model.createData()
    rows = []
    for _ in range(40):
        q, v, a = arm.random_configuration(rng), rng.normal(size=arm.nv), rng.normal(size=arm.nv)
        table = pin.computeJointTorqueRegressor(arm.model, data, q, v, a)
        rows.append(np.hstack([table, np.diag(a), np.diag(v), np.diag(np.sign(v))]))
    every = np.vstack(rows)
    assert np.allclose(every @ null.T, 0.0, atol=1e-9)
    assert np.linalg.matrix_rank(every, tol=1e-6) == len(base.names)


def test_the_urdf_keeps_what_is_not_identified_and_loads_to_the_same_arm(tmp_path):
    _, _, _, result = found("panda")
    path = result.write_urdf(tmp_path / "identified.urdf")
    again = fp.load_arm(path)
    assert np.allclose(theta_of(again), result.theta, atol=1e-12)
    assert again.joint_names == result.nominal.joint_names
    assert path.read_text().count("<mesh") == result.nominal.urdf.count("<mesh")


def test_offset_and_stribeck_are_found_where_they_are_asked_for():
    nominal = fp.load_arm("two_link")
    true = hidden.hidden_plant(nominal, 4)
    log = hidden.calculated(true, hidden.swings(nominal, 4), 4)
    more = 0.6 * np.sign(log.v) * np.exp(-((log.v / 0.1) ** 2))
    shifted = Log(
        t=log.t,
        q=log.q,
        v=log.v,
        tau=log.tau + np.array([2.0, -1.0]) + more,
        joint_names=log.joint_names,
    )
    result = fp.identify([shifted], nominal, offset=True, stribeck=True, stribeck_velocity=0.1)
    for row, truth in zip(result.group("offset"), (2.0, -1.0), strict=True):
        assert abs(row.value - truth) < 3.0 * row.deviation < 1.0
    assert np.array_equal(result.offset, [row.value for row in result.group("offset")])
    rows = result.group("stribeck")
    assert all(abs(row.value - 0.6) < 3.0 * row.deviation for row in rows)
    excess = result.arm.friction * (result.arm.stiction - 1.0)
    assert np.allclose(excess, [row.value for row in rows])


def test_torque_that_is_stamped_late_is_brought_back():
    nominal = fp.load_arm("two_link")
    true = hidden.hidden_plant(nominal, 0)
    log = hidden.calculated(true, hidden.swings(nominal, 0), noise=5e-4)
    late = Log(t=log.t[5:], q=log.q[5:], v=log.v[5:], tau=log.tau[:-5], joint_names=log.joint_names)
    result, moved = fp.identify(log, nominal), fp.identify(late, nominal)
    assert abs(result.fits[0].delay) < 1.5e-3
    assert moved.fits[0].delay == pytest.approx(0.02, abs=1.5e-3)
    for row, other in zip(moved.base_parameters, result.base_parameters, strict=True):
        assert abs(row.value - other.value) < 4.0 * row.deviation


def test_eight_seconds_of_a_closed_loop_are_enough_for_two_links():
    nominal = fp.load_arm("two_link")
    true = hidden.hidden_plant(nominal, 1)
    law = fp.ComputedTorque(nominal, dt=hidden.DT)
    motion = hidden.swings(nominal, 1, duration=8.0)
    rec = hidden.run("two_link", true, motion, 8.0, law)
    result = fp.identify([hidden.measured(rec, 1)], nominal)
    base = base_of(nominal, Parameters(2))
    truth = base.matrix @ theta_of(true)
    off = [
        (row.value - t) / row.deviation
        for row, t in zip(result.base_parameters, truth, strict=True)
    ]
    assert np.all(np.abs(off) < 4.0)
