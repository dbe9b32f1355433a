"""One run of a controller in a setting, and the four numbers that are kept of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fotsmc_pin.analysis.metrics import torque_variation
from fotsmc_pin.analysis.rest_windows import inside
from fotsmc_pin.errors import DivergenceError
from fotsmc_pin.evaluation.stress.judging import LOST
from fotsmc_pin.evaluation.stress.scenario import POSITION_NOISE, VELOCITY_NOISE
from fotsmc_pin.simulation import simulate
from tests.benchmarks.fractional_order.settings import DT

if TYPE_CHECKING:
    from fotsmc_pin.types import Array
    from tests.benchmarks.fractional_order.settings import Setting

DIGITS = 6
"""Significant digits to which gains and outcomes are rounded before anything is done with them."""


class Outcome(NamedTuple):
    """What a run came to; a run that is lost has the tail error `LOST` and no torques.

    Attributes:
        error: RMS of the norm of the tracking error in the span that counts [rad].
        variation: torque variation in that span [N·m/s].
        peak: largest torque of any joint in the whole run [N·m].
        share: largest share of its effort limit that a joint took; 0 where it has none.
    """

    error: float
    variation: float
    peak: float
    share: float

    @property
    def lost(self) -> bool:
        """Whether the run was lost."""
        return self.error >= LOST


def lost() -> Outcome:
    """Return the outcome of a run that is lost."""
    return Outcome(LOST, np.inf, np.inf, np.inf)


class Quiet:
    """A controller whose signals are not recorded, which costs time."""

    def __init__(self, controller: Any) -> None:
        self.dt, self.update, self.reset = controller.dt, controller.update, controller.reset


class DrawnNoise:
    """White noise on position and velocity, drawn for all ticks at once."""

    def __init__(self, setting: Setting) -> None:
        ticks = round(setting.span[1] / DT) + 2
        rng = np.random.default_rng(setting.noise)
        self._arm = setting.nominal
        self._dq = POSITION_NOISE * rng.standard_normal((ticks, setting.nominal.nv))
        self._dv = VELOCITY_NOISE * rng.standard_normal((ticks, setting.nominal.nv))
        self._plain = setting.nominal.is_euclidean

    def reset(self) -> None:
        """Begin with the first tick."""
        self._k = -1

    def __call__(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Return what is measured."""
        self._k += 1
        dq = self._dq[self._k]
        return q + dq if self._plain else self._arm.integrate(q, dq), v + self._dv[self._k]


class OneTickLate:
    """A torque that acts a tick after it was commanded."""

    def __init__(self, nv: int) -> None:
        self._nv = nv

    def reset(self) -> None:
        """Nothing was commanded yet."""
        self._last = np.zeros(self._nv)

    def __call__(self, t: float, tau: Array) -> Array:
        """Return the torque of the last tick."""
        late, self._last = self._last, tau
        return late


def run(setting: Setting, controller: Any) -> Outcome:
    """Run a controller in a setting."""
    perfect = setting.noise is None
    try:
        rec = simulate(
            setting.true,
            Quiet(controller),
            setting.reference,
            setting.span[1],
            q0=setting.q0,
            v0=np.zeros(setting.nominal.nv),
            disturbance=setting.disturbance,
            sensor=None if perfect else DrawnNoise(setting),
            actuator=None if perfect else OneTickLate(setting.nominal.nv),
            integrator="rk4" if perfect else "semi-implicit",
            substeps=1 if perfect else 2,
        )
    except DivergenceError:
        return lost()
    tail = inside(rec.t, setting.span)
    error = float(np.sqrt(np.mean(rec.error_norm[tail] ** 2)))
    if not error < LOST:
        return lost()
    largest = np.abs(rec.tau).max(axis=0)
    return Outcome(
        rounded(error),
        rounded(torque_variation(rec.t[tail], rec.tau[tail])),
        rounded(float(largest.max())),
        rounded(float((largest / setting.nominal.effort_limit).max())),
    )


def rounded(value: float) -> float:
    """Return a number with as many digits as are stored."""
    return float(f"{value:.{DIGITS}g}")
