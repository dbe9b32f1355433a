"""`summarize`: the metrics of a run, each with its definition."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks

if TYPE_CHECKING:
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array


AT_LIMIT = 1.0 - 1e-9

UNITS = {
    "settling_time": "s",
    "settling_time_1_mrad": "s",
    "settling_time_0_1_mrad": "s",
    "rms_error": "rad",
    "tail_rms_error": "rad",
    "max_error": "rad",
    "max_tail_error": "rad",
    "iae": "rad·s",
    "ise": "rad²·s",
    "itae": "rad·s²",
    "peak_torque": "N·m",
    "rms_torque": "N·m",
    "torque_variation": "N·m/s",
    "tail_torque_variation": "N·m/s",
    "chattering": "–",
    "energy": "J",
    "saturation_fraction": "–",
    "duration": "s",
}
"""Units of the metrics in a `Summary`, for an arm whose joints are all revolute."""


@dataclass(frozen=True, kw_only=True)
class Summary:
    """Metrics of a run. `‖e‖` is the Euclidean norm of the tracking error over all joints.

    Units are those of an arm with revolute joints. Where some are prismatic, `‖e‖` adds up radians
    and metres, and the torques newton-metres and newtons: compare such values on one arm only.

    Attributes:
        settling_time: first time after which `‖e‖` stays below 10 mrad [s]; inf if it never does.
        settling_time_1_mrad: the same for 1 mrad [s].
        settling_time_0_1_mrad: the same for 0.1 mrad [s].
        rms_error: root of the mean of `‖e‖²` over the whole run [rad].
        tail_rms_error: the same over the last half of the run [rad].
        max_error: largest `‖e‖` [rad].
        max_tail_error: largest `‖e‖` over the last half of the run [rad].
        iae: integral of `‖e‖` [rad·s].
        ise: integral of `‖e‖²` [rad²·s].
        itae: integral of `t ‖e‖` [rad·s²].
        peak_torque: largest torque of any joint [N·m].
        rms_torque: root of the mean of `‖τ‖²` [N·m].
        torque_variation: `Σ |τ_j(k+1) - τ_j(k)|` over all joints and ticks, per second [N·m/s].
        tail_torque_variation: the same over the last half of the run [N·m/s].
        chattering: share of the torque's power (mean taken off, last half) above 20 Hz.
        energy: `∫ Σ |τ_j v_j| dt`, mechanical work done and absorbed [J].
        saturation_fraction: share of ticks at which some joint is at its effort limit.
        duration: time from the first to the last tick [s].
    """

    settling_time: float
    settling_time_1_mrad: float
    settling_time_0_1_mrad: float
    rms_error: float
    tail_rms_error: float
    max_error: float
    max_tail_error: float
    iae: float
    ise: float
    itae: float
    peak_torque: float
    rms_torque: float
    torque_variation: float
    tail_torque_variation: float
    chattering: float
    energy: float
    saturation_fraction: float
    duration: float

    def as_dict(self) -> dict[str, float]:
        """Return all metrics by name."""
        return asdict(self)


def summarize(rec: Recording) -> Summary:
    """Return the metrics of a run; `Summary` defines each of them."""
    t, error, tau = rec.t, rec.error_norm, rec.tau
    tail = t >= t[0] + 0.5 * (t[-1] - t[0])
    limited = np.abs(tau) >= AT_LIMIT * rec.arm.effort_limit
    return Summary(
        settling_time=settling_time(rec, 1e-2),
        settling_time_1_mrad=settling_time(rec, 1e-3),
        settling_time_0_1_mrad=settling_time(rec, 1e-4),
        rms_error=_rms(error),
        tail_rms_error=_rms(error[tail]),
        max_error=float(error.max()),
        max_tail_error=float(error[tail].max()),
        iae=float(np.trapezoid(error, t)),
        ise=float(np.trapezoid(error**2, t)),
        itae=float(np.trapezoid(t * error, t)),
        peak_torque=float(np.abs(tau).max()),
        rms_torque=_rms(np.linalg.norm(tau, axis=1)),
        torque_variation=torque_variation(t, tau),
        tail_torque_variation=torque_variation(t[tail], tau[tail]),
        chattering=power_above(t[tail], tau[tail], 20.0),
        energy=float(np.trapezoid(np.abs(tau * rec.v).sum(axis=1), t)),
        saturation_fraction=float(limited.any(axis=1).mean()),
        duration=float(t[-1] - t[0]),
    )


def settling_time(rec: Recording, bound: float) -> float:
    """First recorded time after which `‖e‖` stays below `bound` [rad]; inf if it never does."""
    checks.finite_number("bound", bound, above=0.0)
    outside = np.flatnonzero(rec.error_norm >= bound)
    if outside.size == 0:
        return float(rec.t[0])
    last = outside[-1]
    return float(rec.t[last + 1]) if last + 1 < len(rec) else float("inf")


def torque_variation(t: Array, tau: Array) -> float:
    """Sum of the steps of all torques per second [N·m/s]."""
    if len(t) < 2:
        return 0.0
    return float(np.abs(np.diff(tau, axis=0)).sum() / (t[-1] - t[0]))


def power_above(t: Array, tau: Array, frequency: float) -> float:
    """Share of the torques' power, mean taken off, above `frequency` [Hz]."""
    if len(t) < 4:
        return 0.0
    window = np.hanning(len(t))[:, None]
    power = (np.abs(np.fft.rfft((tau - tau.mean(axis=0)) * window, axis=0)) ** 2).sum(axis=1)
    frequencies = np.fft.rfftfreq(len(t), (t[-1] - t[0]) / (len(t) - 1))
    total = float(power.sum())
    return float(power[frequencies > frequency].sum() / total) if total > 0.0 else 0.0


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
