"""`summarize`: the metrics of a run, each with its definition."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.analysis.rest import swings, time_to_rest
from fotsmc_pin.notebook import page_of
from fotsmc_pin.simulation import Recording

if TYPE_CHECKING:
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
    "swing": "rad",
    "time_to_rest": "s",
    "duration": "s",
}
"""Units of the metrics in a `Summary`, for revolute joints."""


def units(position_unit: str) -> dict[str, str]:
    """Return the units of the metrics for joints whose position is in "rad", or in "m"."""
    if checks.choice("position_unit", position_unit, ("rad", "m")) == "rad":
        return dict(UNITS)
    return {name: unit.replace("rad", "m").replace("N·m", "N") for name, unit in UNITS.items()}


@dataclass(frozen=True, kw_only=True)
class Summary:
    """Metrics of a run. `‖e‖` is the Euclidean norm of the tracking error over all joints.

    Units are those of revolute joints; for prismatic joints, metres and newtons take the place of
    radians and newton-metres. On an arm that has both, `summarize` adds them up, and such values
    are for comparison on this arm only: `summarize_by_unit` keeps the kinds apart.

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
        swing: largest swing of a joint, once the reference rests (`rest.swings`) [rad].
        time_to_rest: from the reference's last motion until no joint swings by more than 0.15 mrad
            (`rest.time_to_rest`) [s]; inf if that is never, or the reference moves to the end.
        duration: time from the first to the last tick [s].
        position_unit: "rad", "m", or "rad, m" where `‖e‖` adds up both.
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
    swing: float
    time_to_rest: float
    duration: float
    position_unit: str = "rad"

    def as_dict(self) -> dict[str, float]:
        """Return all metrics by name."""
        return {name: value for name, value in asdict(self).items() if name != "position_unit"}

    @property
    def units(self) -> dict[str, str]:
        """The unit of each metric; "rad + m" where the joints' errors were added up."""
        kinds = [units(unit) for unit in self.position_unit.split(", ")]
        return {name: " + ".join(dict.fromkeys(kind[name] for kind in kinds)) for name in kinds[0]}

    def __str__(self) -> str:
        """Return a line for each metric, with its value and unit."""
        told = self.as_dict()
        width = max(map(len, told))
        lines = (
            f"{name:<{width}}  {value_with_unit(value, unit)}"
            for (name, value), unit in zip(told.items(), self.units.values(), strict=True)
        )
        return "\n".join(lines)

    _repr_html_ = page_of


def value_with_unit(value: float, unit: str) -> str:
    """Return a metric to four digits with its unit; a time that is infinite is "never"."""
    if np.isposinf(value) and unit == "s":
        return "never"
    return f"{value:.4g}" if unit == "–" else f"{value:.4g} {unit}"


def summarize(rec: Recording) -> Summary:
    """Judge a run; `Summary` defines every metric."""
    checks.instance(
        "rec", rec, (Recording, _Part), "give a recording, as simulate or Recording.load returns it"
    )
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
        swing=float(swings(rec).max()),
        time_to_rest=time_to_rest(rec),
        duration=float(t[-1] - t[0]),
        position_unit=", ".join(dict.fromkeys(rec.arm.position_units)),
    )


def summarize_by_unit(rec: Recording) -> dict[str, Summary]:
    """Return the metrics of the revolute joints and those of the prismatic joints apart.

    Returns:
        A summary for each kind of joint that the arm has, by the unit of its position: "rad", "m".
        `units` gives the units of its metrics.
    """
    kinds = np.array(rec.arm.position_units)
    found = dict.fromkeys(rec.arm.position_units)
    return {unit: summarize(_only(rec, kinds == unit)) for unit in ("rad", "m") if unit in found}


def _only(rec: Recording, joints: Array) -> Any:
    """Return what `summarize` reads of a run, for some of the joints."""
    return rec if joints.all() else _Part(rec, joints)


class _Part:
    """Some joints of a recording, as far as its metrics look at them."""

    def __init__(self, rec: Recording, joints: Array) -> None:
        arm, chosen = rec.arm, np.flatnonzero(joints)
        self.t = rec.t
        self.arm = SimpleNamespace(
            effort_limit=arm.effort_limit[joints],
            position_units=tuple(arm.position_units[j] for j in chosen),
        )
        self.e, self.v, self.v_d, self.tau = (
            part[:, joints] for part in (rec.e, rec.v, rec.v_d, rec.tau)
        )
        self.error_norm = np.linalg.norm(self.e, axis=1)

    def __len__(self) -> int:
        """Return the number of recorded ticks."""
        return len(self.t)


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
