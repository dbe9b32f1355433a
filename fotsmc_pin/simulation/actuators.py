"""What actuators make of a commanded torque: delay, lag, limits on its rate.

An actuator is any callable `(t, tau) -> tau`, called once per tick; a `reset()` is called at the
start of a run if it has one. `sensors.Chain` puts several one after the other.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from fotsmc_pin import checks

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class TickDelay:
    """A delay of the torque by whole ticks; also usable for a sensor's `q` and `v`.

    Until the first value has passed the delay, a sensor repeats its first values, and a torque is
    0, as nothing has been commanded yet.

    Args:
        ticks: number of ticks.

    Raises:
        ArgumentError: a negative or fractional number of ticks.
    """

    def __init__(self, ticks: int) -> None:
        self.ticks = checks.count("ticks", ticks, at_least=0)
        self._waiting: deque[tuple[Array, ...]] = deque()

    def reset(self) -> None:
        """Drop all delayed values."""
        self._waiting.clear()

    @overload
    def __call__(self, t: float, tau: Array, /) -> Array: ...
    @overload
    def __call__(self, t: float, q: Array, v: Array, /) -> tuple[Array, Array]: ...
    def __call__(self, t: float, *values: Array) -> Any:
        """Return the values of `ticks` ticks ago."""
        fresh = tuple(np.array(value) for value in values)
        if not self._waiting:
            first = fresh if len(fresh) > 1 else (np.zeros_like(fresh[0]),)
            self._waiting.extend([first] * self.ticks)
        self._waiting.append(fresh)
        late = self._waiting.popleft()
        return late if len(late) > 1 else late[0]


class TorqueRateLimit:
    """Drives with a limited rate of torque.

    Args:
        arm: the arm that is driven.
        rate: largest rate of the torque, one number or one per joint [N·m/s, N/s].
        dt: period of a tick [s].

    Raises:
        ArgumentError: a rate or a period that is not above 0.
    """

    def __init__(self, arm: Arm, *, rate: ArrayLike, dt: float) -> None:
        self.arm = arm
        self.rate = checks.per_joint("rate", rate, arm.nv, above=0.0)
        self.dt = checks.finite_number("dt", dt, above=0.0)
        self.reset()

    def reset(self) -> None:
        """Forget the last torque; the next one is a first one, which is not limited."""
        self._last: Array | None = None

    def __call__(self, t: float, tau: Array) -> Array:
        """Return the torque that the drive reaches."""
        if self._last is not None:
            step = self.rate * self.dt
            tau = np.clip(tau, self._last - step, self._last + step)
        self._last = np.array(tau)
        return self._last.copy()


class TorqueLag:
    """A drive whose torque follows its command as a first-order lag.

    Args:
        bandwidth: corner frequency [rad/s].
        dt: period of a tick [s].

    Raises:
        ArgumentError: a number that is not above 0.
    """

    def __init__(self, *, bandwidth: float, dt: float) -> None:
        self.bandwidth = checks.finite_number("bandwidth", bandwidth, above=0.0)
        self.dt = checks.finite_number("dt", dt, above=0.0)
        self.reset()

    def reset(self) -> None:
        """Forget the torque; the next one is reached at once."""
        self._torque: Array | None = None

    def __call__(self, t: float, tau: Array) -> Array:
        """Return the torque that the drive has reached."""
        if self._torque is None:
            self._torque = np.array(tau)
        share = 1.0 - math.exp(-self.bandwidth * self.dt)
        self._torque = self._torque + share * (tau - self._torque)
        return self._torque.copy()
