"""Velocity from position, for arms without tachometers: filtered, or robust and exact."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import sig
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class FilteredDifferentiator(SharesNothing):
    """Backward differences through a first-order low-pass.

    Args:
        arm: the arm whose positions are given; continuous joints may turn on and on.
        dt: nominal period of a tick [s].
        bandwidth: corner frequency of the low-pass [rad/s].

    Raises:
        ArgumentError: a number that is not above 0.
    """

    def __init__(self, arm: Arm, dt: float, *, bandwidth: float = 300.0) -> None:
        self.arm = arm
        self.dt = checks.finite_number("dt", dt, above=0.0)
        self.bandwidth = checks.finite_number("bandwidth", bandwidth, above=0.0)
        self.reset()

    @property
    def delay(self) -> float:
        """How late slow changes of the velocity come through [s], at the nominal period.

        Half a tick of the difference, and `1 / (e^{bandwidth dt} - 1)` ticks of the filter.
        """
        return self.dt * (0.5 + 1.0 / math.expm1(self.bandwidth * self.dt))

    def reset(self) -> None:
        """Forget every position."""
        self._last: Array | None = None
        self._v = np.zeros(self.arm.nv)

    def update(self, q: ArrayLike, dt: float | None = None) -> Array:
        """Return the velocity (nv,) [rad/s, m/s] after one more position; zero after the first.

        Args:
            q: measured configuration (nq,).
            dt: measured time since the last one [s]; the nominal one if None.
        """
        period = self.dt if dt is None else checks.finite_number("dt", dt, above=0.0)
        if self._last is not None:
            share = -math.expm1(-self.bandwidth * period)
            self._v += share * (self.arm.difference(self._last, q) / period - self._v)
        self._last = np.array(q, dtype=np.float64)
        return self._v.copy()


class ExactDifferentiator(SharesNothing):
    """The robust exact differentiator of second order, which needs no corner frequency.

    It follows any position whose jerk stays below `jerk` without lag, up to an error in velocity of
    the order `jerk dt²`, or `jerk^{1/3} ε^{2/3}` with noise of size `ε`:

        ẋ = y - 2 L^{1/3} sig(x - q)^{2/3}
        ẏ = z - 1.5 L^{1/2} sig(y - ẋ)^{1/2}
        ż = -1.1 L sign(z - ẏ)

    Args:
        arm: the arm whose positions are given.
        dt: nominal period of a tick [s].
        jerk: bound `L` of the third derivative of the position, one number or one per joint
            [rad/s³, m/s³]. In a closed loop it has to cover what the controller does, not only what
            the reference asks for: where it is too small the estimate lags and the loop may become
            unstable; where it is larger than needed the noise comes through.

    Raises:
        ArgumentError: a number that is not above 0.

    Source: Levant, International Journal of Control, 2003.
    """

    def __init__(self, arm: Arm, dt: float, *, jerk: ArrayLike = 2e4) -> None:
        self.arm = arm
        self.dt = checks.finite_number("dt", dt, above=0.0)
        self.jerk = checks.per_joint("jerk", jerk, arm.nv, above=0.0)
        self.reset()

    def reset(self) -> None:
        """Forget every position."""
        self._last: Array | None = None
        self._moved = False
        self._state = np.zeros((4, self.arm.nv))

    def update(self, q: ArrayLike, dt: float | None = None) -> Array:
        """Return the velocity (nv,) [rad/s, m/s] after one more position; zero after the first.

        Args:
            q: measured configuration (nq,).
            dt: measured time since the last one [s]; the nominal one if None.
        """
        period = self.dt if dt is None else checks.finite_number("dt", dt, above=0.0)
        if self._last is not None:
            step = self.arm.difference(self._last, q)
            if self._moved:
                follow(period, self.jerk, *self._state)
            else:  # The first difference is the start; the law would take long to find it.
                self._state[:2] = step, step / period
                self._moved = True
            self._state[3] += step
        self._last = np.array(q, dtype=np.float64)
        v: Array = self._state[1].copy()
        return v


@kernel
def follow(dt: float, jerk: Array, x: Array, y: Array, z: Array, travel: Array) -> None:
    """Lead the exact differentiator to the time of the next sample.

    `travel` is the position at the last sample. The terms of Taylor's series
    beyond Euler's keep its accuracy in discrete time (Livne and Levant, Automatica, 2014).
    """
    for i in range(x.size):
        L = jerk[i]
        x_dot = y[i] - 2.0 * L ** (1.0 / 3.0) * sig(x[i] - travel[i], 2.0 / 3.0)
        y_dot = z[i] - 1.5 * math.sqrt(L) * sig(y[i] - x_dot, 0.5)
        z_dot = -1.1 * L * sig(z[i] - y_dot, 0.0)
        x[i] += dt * x_dot + 0.5 * dt * dt * z[i]
        y[i] += dt * y_dot
        z[i] += dt * z_dot
