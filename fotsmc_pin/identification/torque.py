"""Measured against predicted torque of a log."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from scipy.signal import savgol_coeffs

from fotsmc_pin.identification.filtering import (
    ORDER,
    averaging,
    averaging_times,
    configurations,
    half_window,
)
from fotsmc_pin.identification.fit import later
from fotsmc_pin.identification.regressor import SLACK, at_rest, equations, own_columns
from fotsmc_pin.identification.result import TorqueCheck

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.filtering import Piece
    from fotsmc_pin.identification.reading import ReadLog
    from fotsmc_pin.identification.regressor import Parameters
    from fotsmc_pin.types import Array


def torque_check(
    nominal: Arm,
    identified: Arm,
    entry: ReadLog,
    theta: Array,
    parameters: Parameters,
    width: float,
    speed: float,
    shifts: Mapping[int, float],
) -> TorqueCheck:
    """Return measured against predicted torque of one log.

    Args:
        nominal: the arm before.
        identified: the arm after.
        entry: the log.
        theta: parameters (p,), of which only the offset is not in the arm.
        parameters: their order.
        width: of the averages [s].
        speed: of Stribeck's curve [rad/s, m/s].
        shifts: time by which torque is late, by identity of the piece; found where it is missing.
    """
    offset = theta[parameters.groups["offset"]] if "offset" in parameters.groups else 0.0
    columns: list[tuple[Array, ...]] = []
    errors: list[tuple[Array, Array, Array]] = []
    delays = []
    for piece in entry.pieces:
        system = equations(nominal, piece, parameters, width, speed)
        shift = shifts.get(id(piece))
        if shift is None:
            noise = np.maximum(rms_of(noise_of(piece)), 1e-9)
            shift = later(system, 0.0, theta, noise, search=True)
        delays.append(shift)
        ours = model_torque(identified, piece) + offset
        before = model_torque(nominal, piece)
        at = averaging_times(piece, width, SLACK)
        matrix = averaging(at, piece.t, width)
        moved = averaging(at + shift, piece.t, width)
        columns.append((at, moved @ piece.tau, matrix @ ours, matrix @ before, system.used.T))
        measured = late_torque(piece, shift)
        moving = ~at_rest(piece)
        parts = (measured - ours, measured - before, noise_of(piece))
        errors.append(tuple(np.where(moving, part, np.nan) for part in parts))
    at, measured, predicted, by_nominal, used = (
        np.concatenate(parts) for parts in zip(*columns, strict=True)
    )
    error, nominal_error, floor = (
        rms_of(np.concatenate(parts)) for parts in zip(*errors, strict=True)
    )
    return TorqueCheck(
        label=entry.log.label,
        t=at,
        measured=measured,
        predicted=predicted,
        by_nominal=by_nominal,
        used=used,
        error=error,
        nominal_error=nominal_error,
        floor=floor,
        delay=float(np.mean(delays)),
    )


def model_torque(arm: Arm, piece: Piece) -> Array:
    """Return the torque (T, nv) that an arm needs for the motion, friction included."""
    model, data = arm.model, arm.model.createData()
    tau = np.array(
        [
            pin.rnea(model, data, q, v, a)
            for q, v, a in zip(configurations(arm, piece.x), piece.v, piece.a, strict=True)
        ]
    )
    own = own_columns(piece, arm.stribeck_velocity)
    more = arm.friction * (arm.stiction - 1.0)
    tau += own["damping"] * arm.damping + own["friction"] * arm.friction
    return np.asarray(tau + own["stribeck"] * more)


def late_torque(piece: Piece, shift: float) -> Array:
    """Return the measured torque (T, nv), sample by sample, moved in time by whole samples."""
    steps = round(shift / piece.dt)
    rows = np.clip(np.arange(len(piece.t)) + steps, 0, len(piece.t) - 1)
    return piece.raw_tau[rows]


def noise_of(piece: Piece) -> Array:
    """Return what no smooth torque explains (T, nv), as large as noise was before smoothing."""
    half = half_window(piece.dt)
    left = 1.0 - savgol_coeffs(2 * half + 1, ORDER)[half]
    return np.asarray((piece.raw_tau - piece.tau) / np.sqrt(left))


def rms_of(table: Array) -> Array:
    """Return the root mean square of each column (nv,); NaN does not count."""
    count = np.maximum(np.sum(np.isfinite(table), axis=0), 1)
    return np.asarray(np.sqrt(np.nansum(table**2, axis=0) / count))
