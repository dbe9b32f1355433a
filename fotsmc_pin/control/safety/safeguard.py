"""`Safeguard`: what stands between any controller and real drives."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.safety.drives import Drives
from fotsmc_pin.control.safety.limit_filter import LimitFilter
from fotsmc_pin.control.safety.safe_stop import SafeStop
from fotsmc_pin.control.safety.soft_start import SoftStart
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.copying import SharesNothing
from fotsmc_pin.errors import MeasurementError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.control.friction_compensation import FrictionCompensation
    from fotsmc_pin.control.safety.guarded import Guarded
    from fotsmc_pin.control.safety.limits import Limits
    from fotsmc_pin.types import Array

TORQUES = ("tau", "recent", "v")
"""Vectors of a safeguard's memory."""
RECENT = 100.0
"""Rate at which the torque is averaged that a stop without the law begins with [1/s]."""


class Safeguard(SharesNothing):
    """Wraps a controller: soft start, torque-rate limit, watchdog and safe stop.

    It has the face of a controller (`dt`, `update`, `reset`, `signals`) and works with all of them.
    A stop is latched; only `reset` ends it. It begins when `stop` is called, when a measurement is
    not usable, when a tick comes later than `watchdog`, or when a joint is faster than
    `speed_margin` times its limit. The arm brakes on a `BrakingPath` and is held where it comes to
    rest. The law itself follows that path, as it knows the arm best, unless it is the law that is
    in doubt: where a joint was too fast or a measurement is unusable, and where the path is not
    kept. Then a `Brake` does, which needs nothing but the nominal model.

    Torques are the total ones of `M a + C v + G = τ`. What the drives of a robot add themselves is
    told by `compensates`, and `sent` is what remains to be commanded; the limits hold for both.

    Attributes:
        controller: what is wrapped.
        stopped: why the safe stop is on, in plain words; None while all is well.
        sent: the last tick's torque without what the drives add (nv,): what to command a robot.
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
        stop_ramp: float = 0.1,
        limits: Limits | None = None,
    ) -> None:
        """Wrap a controller.

        Args:
            controller: any controller, or one that learns its model.
            soft_start: time over which the start error is faded out of the reference [s].
            torque_rate: largest rate of each torque [N·m/s, N/s], the safe stop included; None for
                no limit.
            friction_compensation: is added to the torque, unless the drives do that themselves.
            watchdog: longest time between two ticks before a safe stop [s]; ten ticks if None.
            speed_margin: share of the arm's speed limits at which a safe stop begins.
            stop_ramp: least time in which a safe stop brakes [s].
            limits: what the arm may never pass, in a safe stop too; see `Limits`.

        Raises:
            ArgumentError: a number out of its bounds.
        """
        self.controller, self.arm, self.dt = controller, controller.arm, controller.dt
        self._lead = SoftStart(self.arm, soft_start)
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
        self.stop_ramp = checks.finite_number("stop_ramp", stop_ramp, above=0.0)
        self._stop = SafeStop(self.arm, self.dt, self.stop_ramp, self._fastest)
        self._drives = Drives(self.arm)
        self._limits = None if limits is None else LimitFilter(limits, self.dt, self._rate)
        self.reset()

    @property
    def compensates(self) -> tuple[str, ...]:
        """What the drives add themselves: any of "gravity", "coriolis", "friction".

        `run_realtime` sets it to what the robot declares.
        """
        return self._drives.compensates

    @compensates.setter
    def compensates(self, words: tuple[str, ...]) -> None:
        self._drives = Drives(self.arm, words)

    @property
    def signals(self) -> dict[str, Array]:
        """The controller's signals, and those of the limits."""
        return self.controller.signals | (self._limits.signals if self._limits else {})

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, where the controller lets a recorder read them."""
        live: dict[str, Array] = getattr(self.controller, "live_signals", {})
        return live | self._limits.live_signals if live and self._limits else live

    @property
    def gains(self) -> Any:
        """The controller's gains."""
        return self.controller.gains

    @property
    def about(self) -> dict[str, Any]:
        """What the controller says of itself for a recording's metadata."""
        return dict(getattr(self.controller, "about", {}))

    def reset(self) -> None:
        """End a stop and begin anew, softly, from wherever the arm is."""
        self.controller.reset()
        self._lead.reset()
        self._stop.reset()
        self.stopped: str | None = None
        self._tau = np.zeros(self.arm.nv)
        self._recent = self.sent = self._nothing = self._v = self._tau
        self._q: Array | None = None
        self._target: tuple[Array, Array, Array] | None = None
        if self._limits:
            self._limits.reset()

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, the controller's memory included, as arrays."""
        own: dict[str, Any] = {name: getattr(self, f"_{name}") for name in TORQUES} | {
            "sent": self.sent,
            "stopped": self.stopped or "",
            "q": [] if self._q is None else self._q,
            "target": [] if self._target is None else np.concatenate(self._target),
        }
        return (
            {name: np.array(value) for name, value in own.items()}
            | with_prefix("soft_start", self._lead.save_state())
            | with_prefix("safe_stop", self._stop.save_state())
            | with_prefix("controller", self.controller.save_state())
            | with_prefix("limits", self._limits.save_state() if self._limits else {})
        )

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        n, nq = self.arm.nv, self.arm.nq
        tau, recent, v, sent = (
            checks.finite_vector(name, present(arrays, name), n) for name in (*TORQUES, "sent")
        )
        stopped = str(present(arrays, "stopped")) or None
        q = present(arrays, "q")
        place = checks.finite_vector("q", q, nq) if np.size(q) else None
        given, target = present(arrays, "target"), None
        if np.size(given):
            whole = checks.finite_vector("target", given, nq + 2 * n)
            target = (whole[:nq], whole[nq : nq + n], whole[nq + n :])
        lead, stop = copy.copy(self._lead), copy.copy(self._stop)
        lead.restore_state(part(arrays, "soft_start"))
        stop.restore_state(part(arrays, "safe_stop"))
        self.controller.restore_state(part(arrays, "controller"))
        if self._limits:
            self._limits.restore_state(part(arrays, "limits"))
        self._lead, self._stop, self._tau, self._recent = lead, stop, tau, recent
        self._v, self.sent, self.stopped = v, sent, stopped
        self._q, self._target = place, target

    def stop(self, reason: str = "asked for", *, trust_law: bool = True) -> None:
        """Begin a safe stop; the next `update` is its first tick.

        Args:
            reason: in plain words; the first one is kept.
            trust_law: let the law brake, as long as it keeps the path.
        """
        if self.stopped is None:
            self.stopped = reason
        self._stop.by_law = self._stop.by_law and trust_law

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

        An unusable measurement begins a safe stop and is not raised. While there is none that is
        usable, the braking path stands in for it.
        """
        period = self.dt if dt is None else dt
        if not 0.0 < period <= self.watchdog:
            self.stop(f"a tick of {period:g} s, the watchdog allows {self.watchdog:g} s")
            period, dt = self.dt, None
        if self._limits is not None:
            self._limits.take(q, v)
        state = self._measured(q, v)
        target = self._wanted(state, q_d, v_d, a_d, period)
        tau, friction = None, self._nothing
        if state is not None and target is not None and self._law_acts:
            try:
                given = self.controller.update(*state, *target, dt=dt)
                tau = checks.finite_vector("torque", given, self.arm.nv)
            except (MeasurementError, ValueError) as error:
                self.stop(f"measurement: {error}", trust_law=False)
                target = self._wanted(state, q_d, v_d, a_d, period)
        if target is None:  # Nothing was ever measured.
            self._tau = self.sent = np.zeros(self.arm.nv)
            return self._tau.copy()
        by_law = tau is not None
        if tau is None:
            tau = self._stop.torque(state, target, period)
        elif self._friction is not None and not self._drives.hides_friction:
            friction = self._friction.torque(target[1])
            tau = tau + friction
        if state is not None:
            self._q, self._v = state
        if self._target is None:  # What acts before the first torque is what the drives add.
            self._tau = self._drives.added(self._q, self._v)
        self._target = target
        self._send(tau, period, by_law=by_law)
        if by_law:
            self.controller.note_applied(self._tau, friction)
        return self._tau.copy()

    @property
    def _law_acts(self) -> bool:
        return self.stopped is None or self._stop.by_law

    def _measured(self, q: ArrayLike, v: ArrayLike) -> tuple[Array, Array] | None:
        """Return position and speed as they are to be used; None where they cannot be."""
        try:
            place = np.array(checks.finite_vector("q", q, self.arm.nq))
            speed = np.array(checks.finite_vector("v", v, self.arm.nv))
        except ValueError as error:
            self.stop(f"measurement: {error}", trust_law=False)
            return None
        if (np.abs(speed) > self._fastest).any():
            joint = self.arm.joint_names[int(np.argmax(np.abs(speed) - self._fastest))]
            is_first = self.stopped is None and self._q is not None
            self.stop(f"{joint} is faster than its limit allows", trust_law=False)
            # One wild reading is no speed to brake from.
            speed = self._v if is_first else np.clip(speed, -self._fastest, self._fastest)
        return place, speed

    def _wanted(
        self, state: tuple[Array, Array] | None, q_d: Any, v_d: Any, a_d: Any, period: float
    ) -> tuple[Array, Array, Array] | None:
        """Return what is to be followed: the reference, softly led into, or the braking path."""
        if self.stopped is None and state is not None:
            try:
                return self._lead.lead(*state, q_d, v_d, a_d, period)
            except (TypeError, ValueError) as error:
                self.stop(f"reference: {error}", trust_law=False)
        if not self._stop.is_under_way:
            last = state if self._q is None else (self._q, self._v)
            if last is None:
                return None
            self._stop.begin(last, self._target, self._recent)
        return self._stop.advance(state, self._recent, period)

    def _send(self, tau: Array, period: float, *, by_law: bool) -> None:
        """Bring a torque within all limits, and note it and what of it is to be commanded."""
        added = self._drives.added(self._q, self._v)

        def allowed(tau: Array) -> Array:
            limit = self.arm.effort_limit
            if self._rate is not None:
                step = self._rate * period
                tau = np.clip(tau, self._tau - step, self._tau + step)
                tau = np.clip(tau, self.sent + added - step, self.sent + added + step)
            if self._drives.adds:
                tau = np.clip(tau, added - limit, added + limit)
            return np.clip(tau, -limit, limit)

        tau = allowed(tau)
        if self._limits is not None:
            is_free = self._rate is None and not self._drives.adds
            terms = getattr(self.controller, "model_terms", None) if by_law else None
            tau = self._limits.torque(tau, None if is_free else allowed, terms)
            if self._limits.broken is not None:
                self.stop(self._limits.broken, trust_law=False)
        self._tau, self.sent = tau, tau - added if self._drives.adds else tau
        self._recent = self._recent + min(RECENT * period, 1.0) * (self._tau - self._recent)
