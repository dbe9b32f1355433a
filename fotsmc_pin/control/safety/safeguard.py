"""`Safeguard`: what stands between any controller and real drives."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.safety.soft_start import SoftStart, Unled
from fotsmc_pin.control.safety.steps import stopping, too_fast, within_limits, within_rate
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.control.wrapper import Wrapper
from fotsmc_pin.errors import MeasurementError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.control.friction_compensation import FrictionCompensation
    from fotsmc_pin.control.safety.guarded import Guarded
    from fotsmc_pin.types import Array


class Safeguard(Wrapper):
    """Wraps a controller: soft start, torque-rate limit, watchdog and safe stop.

    It has the face of a controller (`dt`, `update`, `reset`, `signals`) and works with all of them.
    A stop is latched: torque goes over from the last one to gravity compensation and damping,

        τ = (1 - ρ) τ_last + ρ (G0(q) - 10/s diag(M0(q)) v),   ρ = 0 … 1 over `stop_ramp`,

    so that the arm comes to rest and floats. It begins when `stop` is called, when a measurement is
    not usable, when a tick comes later than `watchdog`, or when a joint is faster than
    `speed_margin` times its limit. Only `reset` ends it.

    Attributes:
        controller: what is wrapped.
        stopped: why the safe stop is on, in plain words; None while all is well.
    """

    def __init__(
        self,
        controller: Guarded,
        *,
        soft_start: float = 1.0,
        torque_rate: ArrayLike | None = None,
        friction_compensation: FrictionCompensation | None = None,
        watchdog: float | None = None,
        speed_margin: float = 1.2,
        stop_ramp: float = 0.3,
    ) -> None:
        """Wrap a controller.

        Args:
            controller: any controller, or one that learns its model.
            soft_start: time over which the start error is faded out of the reference [s].
            torque_rate: largest rate of each torque [N·m/s, N/s], the safe stop included; None for
                no limit.
            friction_compensation: is added to the torque.
            watchdog: longest time between two ticks before a safe stop [s]; ten ticks if None.
            speed_margin: share of the arm's speed limits at which a safe stop begins.
            stop_ramp: time in which a safe stop takes over [s].

        Raises:
            ArgumentError: a number out of its bounds.
        """
        self.controller, self.arm, self.dt = controller, controller.arm, controller.dt
        # A task starts where the arm is by itself, and its reference are poses.
        starts_softly = getattr(controller, "follows_poses", False)
        self._lead = Unled() if starts_softly else SoftStart(self.arm, soft_start)
        self._rate = (
            None
            if torque_rate is None
            else checks.per_joint("torque_rate", torque_rate, self.arm.nv, above=0.0)
        )
        self._friction = friction_compensation
        default = 10.0 * self.dt if watchdog is None else watchdog
        self.watchdog = checks.finite_number("watchdog", default, above=0.0)
        margin = checks.finite_number("speed_margin", speed_margin, above=0.0)
        self._fastest = margin * self.arm.velocity_limit
        self.stop_ramp = checks.finite_number("stop_ramp", stop_ramp, at_least=0.0)
        self.reset()

    @property
    def signals(self) -> dict[str, Array]:
        """The controller's signals."""
        signals: dict[str, Array] = self.controller.signals
        return signals

    def reset(self) -> None:
        """End a stop and begin anew, softly, from wherever the arm is."""
        self.controller.reset()
        self._lead.reset()
        self.stopped: str | None = None
        self._ramp = 0.0
        self._tau = np.zeros(self.arm.nv)
        self._before_stop = self._tau
        self._q: Array | None = None

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, the controller's memory included, as arrays."""
        own: dict[str, Any] = {
            "tau": self._tau,
            "before_stop": self._before_stop,
            "ramp": self._ramp,
            "stopped": self.stopped or "",
            "q": [] if self._q is None else self._q,
        }
        return (
            {name: np.array(value) for name, value in own.items()}
            | with_prefix("soft_start", self._lead.save_state())
            | with_prefix("controller", self.controller.save_state())
        )

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        n, nq = self.arm.nv, self.arm.nq
        tau = checks.finite_vector("tau", present(arrays, "tau"), n)
        before_stop = checks.finite_vector("before_stop", present(arrays, "before_stop"), n)
        ramp = checks.finite_number("ramp", present(arrays, "ramp"))
        stopped = str(present(arrays, "stopped")) or None
        q = present(arrays, "q")
        place = checks.finite_vector("q", q, nq) if np.size(q) else None
        lead = copy.copy(self._lead)
        lead.restore_state(part(arrays, "soft_start"))
        self.controller.restore_state(part(arrays, "controller"))
        self._lead, self._tau, self._before_stop = lead, tau, before_stop
        self._ramp, self.stopped, self._q = ramp, stopped, place

    def stop(self, reason: str = "asked for") -> None:
        """Begin a safe stop; the next `update` is its first tick."""
        if self.stopped is None:
            self.stopped, self._ramp, self._before_stop = reason, 0.0, self._tau.copy()

    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        q_d: ArrayLike,
        v_d: ArrayLike,
        a_d: ArrayLike,
        dt: float | None = None,
    ) -> Array:
        """Advance by one tick; arguments and result are those of `Controller.update`.

        An unusable measurement begins a safe stop and is not raised. Until a usable one comes
        again, the last usable position stands in, at rest.
        """
        period = self.dt if dt is None else dt
        if not 0.0 < period <= self.watchdog:
            self.stop(f"a tick of {period:g} s, the watchdog allows {self.watchdog:g} s")
            period, dt = self.dt, None
        tau = self._guarded(q, v, q_d, v_d, a_d, period, dt)
        if self.stopped is not None:
            tau = self._safe_stop(q, v, period)
        sent = np.array(tau, dtype=np.float64)
        if self._rate is not None:
            within_rate(sent, self._tau, self._rate, period)
        within_limits(sent, self.arm.effort_limit)
        self._tau = sent
        return sent.copy()

    def _guarded(
        self, q: Any, v: Any, q_d: Any, v_d: Any, a_d: Any, period: float, dt: float | None
    ) -> Array:
        """Return the controller's torque, or begin a stop."""
        if self.stopped is not None:
            return self._tau
        try:
            speed = checks.finite_vector("v", v, self.arm.nv)
            if too_fast(speed, self._fastest):
                joint = self.arm.joint_names[int(np.argmax(np.abs(speed) - self._fastest))]
                self.stop(f"{joint} is faster than its limit allows")
                return self._tau
            target = self._lead.lead(q, speed, q_d, v_d, a_d, period)
            tau: Array = self.controller.update(q, speed, *target, dt=dt)
        except (MeasurementError, ValueError) as error:
            self.stop(f"measurement: {error}")
            return self._tau
        if self._friction is not None:
            tau = tau + self._friction.torque(target[1])
        self._q = np.array(q, dtype=np.float64)
        return tau

    def _safe_stop(self, q: ArrayLike, v: ArrayLike, period: float) -> Array:
        """Return one tick of the way to gravity compensation and damping."""
        try:
            place = checks.finite_vector("q", q, self.arm.nq)
            speed = checks.finite_vector("v", v, self.arm.nv)
            self._q = place
        except ValueError:
            speed = np.zeros(self.arm.nv)
        if self._q is None:
            return np.zeros(self.arm.nv)
        weight, inertia = self.arm.gravity(self._q), np.diag(self.arm.mass_matrix(self._q)).copy()
        self._ramp = min(1.0, self._ramp + (period / self.stop_ramp if self.stop_ramp else 1.0))
        torque = np.zeros(self.arm.nv)
        last, fastest = self._before_stop, self._fastest
        stopping(self._ramp, last, weight, inertia, speed, fastest, torque)
        return torque
