"""From the samples of a log to smooth motion, and to averages that torque and model share.

Position is smoothed and differentiated by a Savitzky-Golay filter, which delays nothing. One
equation of the fit is then the average of the equation of motion over some hundredths of a second
with a Gaussian weight: torque and each column of the model are averaged alike (parallel filtering),
so that what the average takes away it takes away on both sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import savgol_coeffs, savgol_filter
from scipy.sparse import csr_array

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

ORDER = 5
"""Of the polynomial that is laid through the samples of a window."""
WINDOW = 0.02
"""Half of that window [s], where the log is fast enough."""
LEAST_WINDOW = 4
"""Samples on either side that it has at least."""
WIDTHS = (0.02, 0.03, 0.045, 0.07, 0.1)
"""Standard deviations of the Gaussian weight to choose from [s]."""
REACH = 4.0
"""Where the weight ends, in standard deviations."""
SPACING = 2.0
"""From one average to the next, in standard deviations."""
NOISE_SHARE = 0.01
"""Noise of an averaged acceleration over the acceleration itself that is put up with."""
BREAK = 5.0
"""Gap between samples, over the usual one, that the filters are not led across."""
SHORTEST = 1.0
"""Length of a piece between gaps that is still worth using [s]."""
REGULAR = 1e-3
"""Deviation of a step from the period, over the period, that needs no resampling."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """An unbroken piece of a log at a constant rate, smoothed, `T` samples.

    Attributes:
        t: time (T,) [s].
        x: joint positions, unwound (T, nv) [rad, m].
        v: velocity (T, nv).
        a: acceleration (T, nv).
        tau: torque (T, nv), smoothed like the positions.
        raw_tau: torque as it was measured (T, nv).
        position_noise: standard deviation of one reading of the position (nv,) [rad, m].
    """

    t: Array
    x: Array
    v: Array
    a: Array
    tau: Array
    raw_tau: Array
    position_noise: Array

    @property
    def dt(self) -> float:
        """Period [s]."""
        return float(self.t[1] - self.t[0])


def joint_positions(arm: Arm, q: Array) -> Array:
    """Return one angle or travel per joint (T, nv), continuous joints unwound."""
    x = np.empty((len(q), arm.nv))
    for joint in [*arm.model.joints][1:]:
        at = joint.idx_q
        if joint.nq == 2:
            x[:, joint.idx_v] = np.unwrap(np.arctan2(q[:, at + 1], q[:, at]))
        else:
            x[:, joint.idx_v] = q[:, at]
    return x


def configurations(arm: Arm, x: Array) -> Array:
    """Return the configurations (T, nq) of joint positions (T, nv)."""
    q = np.empty((len(x), arm.nq))
    for joint in [*arm.model.joints][1:]:
        column = x[:, joint.idx_v]
        if joint.nq == 2:
            q[:, joint.idx_q], q[:, joint.idx_q + 1] = np.cos(column), np.sin(column)
        else:
            q[:, joint.idx_q] = column
    return q


def period_of(t: Array) -> float:
    """Return the usual time from one sample to the next [s]."""
    return float(np.median(np.diff(t)))


def unbroken(t: Array) -> list[slice]:
    """Return the stretches of rows between gaps, those that are long enough."""
    dt = period_of(t)
    ends = [0, *(np.flatnonzero(np.diff(t) > BREAK * dt) + 1).tolist(), len(t)]
    stretches = [slice(a, b) for a, b in pairwise(ends)]
    least = max(SHORTEST, (4 * LEAST_WINDOW + 2) * dt)
    return [part for part in stretches if t[part.stop - 1] - t[part.start] >= least]


def half_window(dt: float) -> int:
    """Return how many samples the window of the filter has on either side."""
    return max(LEAST_WINDOW, round(WINDOW / dt))


def is_regular(t: Array) -> bool:
    """Return whether the samples come at a constant rate."""
    dt = period_of(t)
    return bool(np.max(np.abs(np.diff(t) - dt)) <= REGULAR * dt)


def smoothed(t: Array, x: Array, tau: Array) -> Piece:
    """Return a piece of a log, brought to a constant rate and smoothed."""
    dt = period_of(t)
    if not is_regular(t):
        even = np.arange(t[0], t[-1], dt)
        x, tau = (
            np.column_stack([np.interp(even, t, column) for column in table.T])
            for table in (x, tau)
        )
        t = even
    else:
        t = t[0] + (t[-1] - t[0]) / (len(t) - 1) * np.arange(len(t))
        dt = float(t[1] - t[0])
    half = half_window(dt)
    size = 2 * half + 1

    def filtered(table: Array, derivative: int = 0) -> Array:
        return np.asarray(savgol_filter(table, size, ORDER, deriv=derivative, delta=dt, axis=0))

    centre = savgol_coeffs(size, ORDER)[half]
    smooth = filtered(x)
    # A residual of the fit has the variance 1 - h of a reading, h the weight of its own sample.
    noise = np.sqrt(np.mean((x - smooth)[half:-half] ** 2, axis=0) / (1.0 - centre))
    inside = slice(half, -half)
    return Piece(
        t=t[inside],
        x=smooth[inside],
        v=filtered(x, 1)[inside],
        a=filtered(x, 2)[inside],
        tau=filtered(tau)[inside],
        raw_tau=tau[inside],
        position_noise=noise,
    )


def chosen_width(pieces: list[Piece]) -> float:
    """Return the least width that keeps the noise of each acceleration small, or the widest [s].

    Averaging leaves of a reading's noise `√(3 dt / (8 √π σ⁵))` times as much in the acceleration:
    the norm of the second derivative of a Gaussian of width σ.
    """
    least = 2.5 * max(piece.dt for piece in pieces)
    moving = np.sqrt(np.mean(np.concatenate([piece.a for piece in pieces]) ** 2, axis=0))
    noise = np.max([piece.position_noise * np.sqrt(piece.dt) for piece in pieces], axis=0)
    for width in WIDTHS:
        if width < least:
            continue
        gain = np.sqrt(3.0 / (8.0 * np.sqrt(np.pi))) / width**2.5
        if np.all(gain * noise <= NOISE_SHARE * moving):
            return width
    return max(WIDTHS[-1], least)


def averaging_times(piece: Piece, width: float, slack: float) -> Array:
    """Return the times of the averages that lie inside a piece, `slack` from its ends (N,) [s]."""
    margin = REACH * width + slack
    return np.arange(piece.t[0] + margin, piece.t[-1] - margin, SPACING * width)


def averaging(times: Array, t: Array, width: float) -> csr_array:
    """Return the matrix (N, T) that averages samples at evenly spaced `t` around `times`."""
    dt = t[1] - t[0]
    reach = int(np.ceil(REACH * width / dt))
    middle = np.round((times - t[0]) / dt).astype(int)
    columns = np.clip(middle[:, None] + np.arange(-reach, reach + 1), 0, len(t) - 1)
    weights = np.exp(-0.5 * ((t[columns] - times[:, None]) / width) ** 2)
    weights /= weights.sum(axis=1, keepdims=True)
    rows = np.repeat(np.arange(len(times)), columns.shape[1])
    return csr_array((weights.ravel(), (rows, columns.ravel())), shape=(len(times), len(t)))
