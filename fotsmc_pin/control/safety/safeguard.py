"""`Safeguard`: what stands between any controller and real drives."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.arguments import demand_round
from fotsmc_pin.control.safety.drives import Drives
from fotsmc_pin.control.safety.limit_filter import LimitFilter
from fotsmc_pin.control.safety.output import Output
from fotsmc_pin.control.safety.safe_stop import SafeStop
from fotsmc_pin.control.safety.seen import Seen
from fotsmc_pin.control.safety.soft_start import SoftStart, Unled
from fotsmc_pin.control.safety.steps import slowed, too_fast
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.control.wrapper import Wrapper
from fotsmc_pin.errors import ArgumentError, MeasurementError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.control.friction_compensation import FrictionCompensation
    from fotsmc_pin.control.safety.guarded import Guarded
    from fotsmc_pin.control.safety.limits import Limits
    from fotsmc_pin.types import Array


class Safeguard(Wrapper):
    """Wraps a controller: soft start, torque-rate limit, watchdog and safe stop.

    It has the face of a controller (`dt`, `update`, `reset`, `signals`) and works with all of them.
    A stop is latched; only `reset` ends it. It begins when `stop` is called, when a measurement is
    not usable, when a tick comes later than `watchdog`, or when a joint is faster than
    `speed_margin` times its limit. The arm brakes on a `BrakingPath` and is held where it comes to
    rest. The law itself follows that path, as it knows the arm best, unless it is the law that is
    in doubt: where a joint was too fast or a measurement is unusable, where the path is not kept,
    and where a joint gets faster than it was. Then a `Brake` does, which needs nothing but the
    nominal model, with a mass at the tool that is found as the stop begins (`Carried`).

    Torques are the total ones of `M a + C v + G = τ`. What the drives of a robot add themselves is
    told by `compensates`, and `sent` is what remains to be commanded; the limits hold for both.

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
        # A task starts where the arm is by itself, and its reference are poses.
        self._is_led = not getattr(controller, "follows_poses", False)
        self._lead = SoftStart(self.arm, soft_start) if self._is_led else Unled()
        rate = np.inf if torque_rate is None else torque_rate
        self._rate = checks.per_joint("torque_rate", rate, self.arm.nv, above=0.0, unlimited=True)
        if friction_compensation is not None and not self._is_led:
            remedy = "leave it out: it follows speeds of joints, and the controller follows poses"
            raise ArgumentError("friction_compensation", friction_compensation, remedy)
        self._friction = friction_compensation
        default = 10.0 * self.dt if watchdog is None else watchdog
        self.watchdog = checks.finite_number("watchdog", default, above=0.0)
        margin = checks.finite_number("speed_margin", speed_margin, above=0.0)
        self._fastest = margin * self.arm.velocity_limit
        self.stop_ramp = checks.finite_number("stop_ramp", stop_ramp, above=0.0)
        self._stop = SafeStop(self.arm, self.dt, self.stop_ramp, self._fastest, self._rate)
        limited = None if torque_rate is None else self._rate
        self._limits = None if limits is None else LimitFilter(limits, self.dt, limited)
        self._seen, self._output = Seen(self.arm), Output(self.arm, self._rate)
        self.reset()
        self._compile()

    @property
    def limits(self) -> Limits | None:
        """What the arm may never pass; None for no limits."""
        return self._limits.limits if self._limits else None

    @property
    def torque_rate(self) -> Array:
        """Largest rate of each torque (nv,) [N·m/s, N/s]; inf for no limit."""
        return self._rate.copy()

    @property
    def compensates(self) -> tuple[str, ...]:
        """What the drives add themselves: any of "gravity", "coriolis", "friction".

        `run_realtime` sets it to what the robot declares.
        """
        return self._output.drives.compensates

    @compensates.setter
    def compensates(self, words: tuple[str, ...]) -> None:
        drives = self._output.drives = Drives(self.arm, words)
        self.controller.feed_friction(not drives.hides_friction)

    @property
    def sent(self) -> Array:
        """The last tick's torque without what the drives add (nv,): what to command a robot."""
        return self._output.sent

    @property
    def signals(self) -> dict[str, Array]:
        """The controller's signals, and those of the limits."""
        signals: dict[str, Array] = self.controller.signals
        return signals | (self._limits.signals if self._limits else {})

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, where the controller lets a recorder read them."""
        live: dict[str, Array] = getattr(self.controller, "live_signals", {})
        return live | self._limits.live_signals if live and self._limits else live

    def reset(self) -> None:
        """End a stop and begin anew, softly, from wherever the arm is."""
        for inner in self._parts.values():
            inner.reset()
        self.stopped: str | None = None
        self._target: tuple[Array, Array, Array] | None = None

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, the controller's memory included, as arrays."""
        target = np.concatenate(self._target or [()])
        saved = {"stopped": np.array(self.stopped or ""), "target": target}
        for name, inner in self._parts.items():
            arrays = {key: np.array(array) for key, array in inner.save_state().items()}
            saved |= with_prefix(name, arrays)
        return saved

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        stopped = str(present(arrays, "stopped")) or None
        given, target = present(arrays, "target"), None
        if np.size(given):
            n, nq = self.arm.nv, self.arm.nq
            whole = checks.finite_vector("target", given, nq + 2 * n)
            target = (whole[:nq], whole[nq : nq + n], whole[nq + n :])
        twins = {name: copy.copy(inner) for name, inner in [*self._parts.items()][:4]}
        for name, twin in twins.items():
            twin.restore_state(part(arrays, name))
        for name, inner in [*self._parts.items()][4:]:
            inner.restore_state(part(arrays, name))
        self._lead, self._stop, self._seen, self._output = twins.values()
        self.stopped, self._target = stopped, target

    @property
    def _parts(self) -> dict[str, Any]:
        parts = (self._lead, self._stop, self._seen, self._output, self.controller, self._limits)
        names = ("soft_start", "safe_stop", "seen", "output", "controller", "limits")
        return {name: inner for name, inner in zip(names, parts, strict=True) if inner is not None}

    def stop(self, reason: str = "asked for", *, trust_law: bool = True) -> None:
        """Begin a safe stop; the next `update` is its first tick.

        Args:
            reason: in plain words; the first one is kept.
            trust_law: let the law brake, as long as it keeps the path.
        """
        if self.stopped is None:
            self.stopped = reason
        self._stop.by_law = self._stop.by_law and trust_law and self._is_led

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
        state, is_believed = self._measured(q, v)
        if state is not None and self._seen.q is None:
            self._seen.see(*state, is_believed=is_believed)
        target = self._led(state, q_d, v_d, a_d, period)
        if self.stopped is not None:
            target = self._braking(state, period, is_believed=is_believed)
        tau, friction = None, np.zeros(self.arm.nv)
        law_acts = self.stopped is None or self._stop.by_law
        if law_acts and state is not None and target is not None:
            try:
                given = self.controller.update(*state, *target, dt=dt)
                tau = np.array(checks.finite_vector("torque", given, self.arm.nv))
            except (MeasurementError, ValueError) as error:
                is_new = self.stopped is None
                self.stop(f"measurement: {error}", trust_law=False)
                if is_new:
                    target = self._braking(state, period, is_believed=is_believed)
        if target is None:  # Nothing was ever measured.
            return np.zeros(self.arm.nv)
        by_law = tau is not None
        if state is not None:
            self._seen.see(*state, is_believed=is_believed)
        if tau is None:
            tau = self._stop.torque(state, self._seen, target, self._output.recent, period)
        elif self._friction is not None and not self._output.drives.hides_friction:
            friction = self._friction.torque(target[1])
            tau += friction
        terms = getattr(self.controller, "model_terms", None) if by_law else None
        h = terms.h if terms is not None and terms.is_bare(self.arm) else self._seen.h
        v = target[1] if state is None else state[1]
        self._output.send(tau, (v, h), self._seen, period, self._limits, terms)
        if self._limits is not None and self._limits.broken is not None:
            self.stop(self._limits.broken, trust_law=False)
        self._target = target if self._is_led or self.stopped is not None else None
        if by_law:
            self.controller.note_applied(self._output.tau, friction)
        return self._output.tau.copy()

    def _measured(self, q: ArrayLike, v: ArrayLike) -> tuple[tuple[Array, Array] | None, bool]:
        """Return the state to work with, if any, and whether its speed was measured."""
        try:
            place = np.array(checks.finite_vector("q", q, self.arm.nq))
            speed = np.array(checks.finite_vector("v", v, self.arm.nv))
            demand_round(self.arm, "q", q, place)
        except ValueError as error:
            self.stop(f"measurement: {error}", trust_law=False)
            return None, False
        if not too_fast(speed, self._fastest):
            return (place, speed), True
        joint = self.arm.joint_names[int(np.argmax(np.abs(speed) - self._fastest))]
        is_first = self.stopped is None and self._seen.q is not None
        self.stop(f"{joint} is faster than its limit allows", trust_law=False)
        if is_first:  # One wild reading is no speed to brake from.
            return (place, self._seen.v), False
        slowed(speed, self._fastest)
        return (place, speed), False

    def _led(
        self, state: tuple[Array, Array] | None, q_d: Any, v_d: Any, a_d: Any, period: float
    ) -> tuple[Array, Array, Array] | None:
        """Return the reference, softly led into; None where it is not to be followed."""
        if self.stopped is None and state is not None:
            try:
                return self._lead.lead(*state, q_d, v_d, a_d, period)
            except (TypeError, ValueError) as error:
                self.stop(f"reference: {error}", trust_law=False)
        return None

    def _braking(
        self, state: tuple[Array, Array] | None, period: float, *, is_believed: bool
    ) -> tuple[Array, Array, Array] | None:
        """Return where the braking path leads; None where nothing was ever measured."""
        seen, stop, output = self._seen, self._stop, self._output
        if seen.q is None:
            return None
        if not stop.is_under_way:
            stop.begin(seen, self._target, output.recent)
        if state is None:
            seen.look_away(stop.path.speed_left)
        else:
            seen.see(*state, is_believed=is_believed)
        return stop.advance(state, seen, (output.tau, output.recent), period)

    def _compile(self) -> None:
        """Run through a stop, so that none has to wait for the compiler."""
        speed, seen = np.zeros(self.arm.nv), self._stop.run_through()
        if not too_fast(speed, self._fastest):
            slowed(speed, self._fastest)
        copy.copy(self._output).send(speed, (speed, seen.h), seen, self.dt)
