"""The error of a pose against Pinocchio and against finite differences, from 0 to π."""

import numpy as np
import pinocchio as pin
import pytest

from fotsmc_pin.control.task_space.directions import Directions
from fotsmc_pin.control.task_space.pose_log import error_of, rate_of_rate, small_rate_of_rate
from fotsmc_pin.errors import ArgumentError

ANGLES = (0.0, 1e-9, 1e-5, 1e-3, 0.049, 0.051, 1.0, 3.0, 3.1415926)
H = 1e-6


def of(X, directions):
    code, m = directions.code, len(directions)
    e, E = np.zeros(m), np.zeros((m, 6))
    error_of(np.ascontiguousarray(X.rotation), X.translation.copy(), code, e, E, np.zeros((24, 6)))
    return e, E


def poses():
    rng = np.random.default_rng(0)
    for angle in ANGLES:
        for _ in range(20):
            axis = rng.normal(size=3)
            axis /= np.linalg.norm(axis)
            yield angle, pin.SE3(pin.exp3(angle * axis), rng.normal(size=3)), rng.normal(size=6)


def test_all_directions_are_the_logarithm_of_pinocchio():
    everything = Directions.read("all")
    for angle, X, _ in poses():
        e, E = of(X, everything)
        assert pin.exp6(pin.Motion(e)).isApprox(X, 1e-12)
        np.testing.assert_allclose(e, pin.log6(X).vector, atol=1e-9)
        if angle < 3.1:
            np.testing.assert_allclose(E, pin.Jlog6(X), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    "chosen", ["all", "position", "orientation", "plane", "axis", "pointing", ("y", "rx", "rz")]
)
def test_rates_are_those_of_finite_differences(chosen):
    directions = Directions.read(chosen)
    for angle, X, nu in poses():
        if angle > 2.0:
            continue
        (ahead, E_ahead), (behind, E_behind) = (
            of(X * pin.exp6(pin.Motion(sign * H * nu)), directions) for sign in (1.0, -1.0)
        )
        _, E = of(X, directions)
        np.testing.assert_allclose((ahead - behind) / (2 * H), E @ nu, rtol=1e-7, atol=1e-7)
        found = np.zeros_like(E)
        R, x = np.ascontiguousarray(X.rotation), X.translation.copy()
        rate_of_rate(R, x, nu, directions.code, found, np.zeros((24, 6)))
        np.testing.assert_allclose(found, (E_ahead - E_behind) / (2 * H), rtol=1e-5, atol=1e-5)


def test_the_series_near_zero_is_the_derivative_too():
    everything, rng = Directions.read("all"), np.random.default_rng(1)
    for _ in range(20):
        e, e_dot = rng.normal(size=(2, 6))
        e *= 0.02 / np.linalg.norm(e)
        E_ahead, E_behind = (
            of(pin.exp6(pin.Motion(e + sign * H * e_dot)), everything)[1] for sign in (1.0, -1.0)
        )
        x, found = rng.normal(size=6), np.zeros(6)
        small_rate_of_rate(e, e_dot, x, found, np.zeros((3, 6)))
        np.testing.assert_allclose(found, (E_ahead - E_behind) @ x / (2 * H), atol=2e-6)


def test_a_swing_does_not_care_about_the_turn_about_its_axis():
    pointing = Directions.read("pointing")
    for _, X, _ in poses():
        spun = X * pin.SE3(pin.exp3(np.array([0.0, 0.0, 2.0])), np.zeros(3))
        e, twin = of(X, pointing)[0], of(spun, pointing)[0]
        np.testing.assert_allclose(e, twin, atol=1e-9)
        seen = X.rotation[:, 2]
        assert np.linalg.norm(e[3:]) == pytest.approx(np.arccos(np.clip(seen[2], -1, 1)), abs=1e-7)


@pytest.mark.parametrize("wrong", ["everything", (), ("rx",), ("x", "w")])
def test_directions_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ArgumentError, match="directions"):
        Directions.read(wrong)
