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
from fotsmc_pin.identification.regressor import (
    MOSTLY_STILL,
    SLACK,
    Equations,
    at_rest,
    own_columns,
)
from fotsmc_pin.identification.result import TorqueCheck

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.filtering import Piece
    from fotsmc_pin.identification.reading import ReadLog
    from fotsmc_pin.types import Array

NO_TABLE = np.zeros((0, 0, 0))
"""Where only the torque of a piece is asked for."""


def torque_check(
    nominal: Arm,
    identified: Arm,
    entry: ReadLog,
    offset: Array,
    width: float,
    shifts: Mapping[int, float],
) -> TorqueCheck:
    """Return measured against predicted torque of one log.

    Args:
        nominal: the arm before.
        identified: the arm after.
        entry: the log.
        offset: constant torque that is not in the arm (nv,) [N·m, N].
        width: of the averages [s].
        shifts: time by which torque is late, by identity of the piece; found where it is missing.
    """
    tables: list[tuple[Array, ...]] = []
    errors: list[tuple[Array, ...]] = []
    delays = []
    for piece in entry.pieces:
        at = averaging_times(piece, width, SLACK)
        matrix, resting = averaging(at, piece.t, width), at_rest(piece)
        used = matrix @ resting.astype(float) < MOSTLY_STILL
        ours, before = model_torque(identified, piece) + offset, model_torque(nominal, piece)
        system = Equations(piece=piece, width=width, times=at, table=NO_TABLE, used=used.T)
        predicted, noise = matrix @ ours, noise_of(piece)
        shift = shifts.get(id(piece))
        if shift is None:
            shift = later(system, 0.0, predicted.T, np.maximum(rms_of(noise), 1e-9), search=True)
        delays.append(shift)
        tables.append((at, system.torque(shift).T, predicted, matrix @ before, used))
        measured = late_torque(piece, shift)
        parts = (measured - ours, measured - before, noise)
        errors.append(tuple(np.where(resting, np.nan, part) for part in parts))
    at, measured, predicted, by_nominal, used = (
        np.concatenate(parts) for parts in zip(*tables, strict=True)
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
