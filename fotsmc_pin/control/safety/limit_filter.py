"""`LimitFilter`: the torque nearest to a law's that keeps an arm within its `Limits`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import restricted, specialized
from fotsmc_pin.control.safety import limit_bounds as rows
from fotsmc_pin.control.safety.limit_bounds import look_back, read_state
from fotsmc_pin.control.safety.limit_kernels import filtered
from fotsmc_pin.control.safety.separation import Separation
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.control.model_terms import ModelTerms
    from fotsmc_pin.control.safety.limits import Limits
    from fotsmc_pin.types import Array

LOCAL = pin.Convention.LOCAL
"""Faster than the default for a mass matrix alone, and the same to rounding."""
UNLIMITED = 1e9
"""Stands for an acceleration or a speed that nothing limits [rad/s², rad/s]."""
LOST = 1.0
"""A bound counts as lost where it is exceeded by this share of a joint's deceleration, for longer
than the delay of the loop."""


class LimitFilter(SharesNothing):
    """Keeps an arm within its limits, one torque after the other.

    A tick is `take`, then `torque`. Where a measurement is not usable, the state stands in to
    which the accelerations that were sent should have led.

    Attributes:
        limits: what is kept.
        has_started: whether a usable state was seen since the last reset.
        broken: which limit could not be kept, in plain words; None while all can.
    """

    linked: ClassVar[frozenset[str]] = frozenset(
        {
            "_model",
            "_data",
            "_M",
            "_h",
            "_q",
            "_v",
            "_sent",
            "_added",
            "_ahead",
            "_filtered",
        }
    )

    def __init__(self, limits: Limits, dt: float, torque_rate: Array | None = None) -> None:
        """Prepare for ticks of `dt` seconds and drives of a limited torque rate (nv,) [N·m/s]."""
        self.limits, self.arm, self._dt = limits, limits.arm, dt
        n, self._nq = self.arm.nv, self.arm.nq
        effort = self.arm.effort_limit
        self._table = table = np.zeros((rows.PENDING + 2 * (limits.delay + 1), n))
        self._work = np.zeros((2 * n + 1, n))
        self._torque = np.zeros((3, n))
        self._state = np.zeros((2, max(n, self.arm.nq)))
        self._places = np.array(self.arm.model.idx_qs[1:], dtype=np.int64)
        speed = np.minimum(limits.velocity_share * np.asarray(limits.velocity), UNLIMITED)
        table[rows.SPEED], table[rows.BRAKING] = speed, limits.braking
        table[rows.ACCELERATION] = np.minimum(np.asarray(limits.acceleration), UNLIMITED)
        table[rows.LEAST_TORQUE], table[rows.MOST_TORQUE] = -effort, effort
        if torque_rate is not None:  # the time in which a torque turns from one limit to the other
            table[rows.LAG] = 2.0 * effort / torque_rate
        has_distances = limits.clearance is not None or limits.box is not None
        self._separation = Separation(limits, dt) if has_distances else None
        self._link()
        self.reset()

    def reset(self) -> None:
        """Forget every tick."""
        self.has_started, self._pace = False, rows.SLOW
        self.broken: str | None = None
        self._lost = 0
        if self._separation is not None:
            self._separation.reset()
        self._table[rows.X : rows.LEAST_TORQUE] = 0.0
        self._table[rows.LEAST :] = 0.0
        self._torque[:] = 0.0
        self._table[rows.LOWER] = self.limits.lower + np.asarray(self.limits.margin)
        self._table[rows.UPPER] = self.limits.upper - np.asarray(self.limits.margin)

    @property
    def signals(self) -> dict[str, Array]:
        """What the limits added to the last torque, (nv,) [N·m, N]."""
        return {"limit_torque": self._added.copy()}

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew."""
        return {"limit_torque": self._added}

    def _demand_start(self, q: ArrayLike, v: ArrayLike) -> None:
        """Refuse a first state beyond the limits; one that is not usable is left to others.

        A joint that starts within the margin of an end is held where it is.

        Raises:
            ArgumentError: naming the joint.
        """
        limits, arm = self.limits, self.arm
        try:
            q = checks.finite_vector("q", q, arm.nq)
            v = checks.finite_vector("v", v, arm.nv)
        except ValueError:
            return
        lower, upper, velocity = (
            np.asarray(part) for part in (limits.lower, limits.upper, limits.velocity)
        )
        x = np.where(np.isfinite(lower) | np.isfinite(upper), q[self._places], 0.0)
        beyond = np.maximum(x - upper, lower - x)
        if (beyond > 0.0).any():
            j = int(np.argmax(beyond))
            remedy = (
                f"{arm.joint_names[j]} starts at {x[j]:.4g} {arm.position_units[j]}, beyond its "
                f"limits {lower[j]:.4g} … {upper[j]:.4g}; bring it back first"
            )
            raise ArgumentError("q", q, remedy)
        if (np.abs(v) > velocity).any():
            j = int(np.argmax(np.abs(v) - velocity))
            remedy = f"{arm.joint_names[j]} starts faster than its limit of {velocity[j]:.4g}"
            raise ArgumentError("v", v, remedy)
        if self._separation is not None:
            self._separation.demand_start(q)
        self._table[rows.LOWER] = np.minimum(self._table[rows.LOWER], x)
        self._table[rows.UPPER] = np.maximum(self._table[rows.UPPER], x)
        self._table[rows.LAST_V] = v
        self.has_started = True

    def take(self, q: Any, v: Any) -> None:
        """Take in the measurement of this tick, or what stands in for one that is not usable.

        Raises:
            ArgumentError: the first state is beyond the limits; it names the joint.
        """
        if not self.has_started:
            self._demand_start(q, v)
            if not self.has_started:
                return
        try:
            self._pace = self._read(q, v)
        except (AttributeError, TypeError):  # not plain arrays of floats
            self._pace = rows.UNUSABLE
        if self._pace == rows.UNUSABLE:
            n, nq = self.arm.nv, self.arm.nq
            try:
                known_q, known_v = checks.finite_vector("q", q, nq), checks.finite_vector("v", v, n)
            except ValueError:
                look_back(self._dt, self._table)
                way, known_v = self._ahead[:2]
                known_q = pin.integrate(self._model, self._q, way)
            self._pace = self._read(known_q, known_v)

    def _read(self, q: Array, v: Array) -> int:
        return read_state(self._dt, q, v, self._nq, self._state, self._places, self._table)

    def torque(
        self,
        tau: Array,
        allowed: Callable[[Array], Array] | None = None,
        terms: ModelTerms | None = None,
    ) -> Array:
        """Return the torque (nv,) nearest to `tau` that keeps the limits.

        Bit for bit `tau` where no limit is near.

        Args:
            tau: what is to be sent, within the limits of torque (nv,) [N·m, N].
            allowed: clips a torque to what may be sent at this tick; None where that is the
                arm's effort limits.
            terms: mass matrix, and `C v + G`, of this state where they are known already.
        """
        if not self.has_started:
            return tau
        table = self._table
        if allowed is not None:
            beyond = np.full(tau.size, np.inf)
            table[rows.LEAST_TORQUE], table[rows.MOST_TORQUE] = allowed(-beyond), allowed(beyond)
        if terms is None:
            pin.crba(self._model, self._data, self._q, LOCAL)
            pin.nonLinearEffects(self._model, self._data, self._q, self._v)
            M, h = self._M, self._h
        else:
            M, h = terms.M, terms.h
        looks_late, late = self._pace == rows.QUICK, h
        if looks_late:
            way, speed, place, a = self._ahead
            if self._nq != tau.size:
                place = pin.integrate(self._model, self._q, way)
            late = pin.rnea(self._model, self._data, place, speed, a)
        worst = self._filtered(
            self._dt, tau, M, h, late, looks_late, self._torque, self._work, table
        )
        if self._separation is not None:
            found = self._separation.accelerations(self._q, self._v, M, h, tau, table)
            if found is not None:
                a, short = found
                wanted = M @ a + h
                self._sent[:] = np.clip(wanted, table[rows.LEAST_TORQUE], table[rows.MOST_TORQUE])
                np.subtract(self._sent, tau, out=self._added)
                table[rows.A] = table[rows.PENDING] = a
                worst = max(worst, short)
        if worst > 0.0 or self._lost:
            self._watch(worst)
        return self._sent.copy()

    def _watch(self, worst: float) -> None:
        """Note a limit that could not be kept for longer than the delay of the loop."""
        self._lost = self._lost + 1 if worst > LOST else 0
        if self._lost > self.limits.delay + 3:
            j = int(np.argmax(self._table[rows.EXCESS]))
            self.broken = f"{self.arm.joint_names[j]} has not the torque to keep its limits"

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        return {
            "table": self._table.copy(),
            "torque": self._torque.copy(),
            "state": self._state.copy(),
            "started": np.array(self.has_started),
            "lost": np.array(self._lost),
            "broken": np.array(self.broken or ""),
        }

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape.
        """
        table = checks.finite_array(
            "table", present(arrays, "table"), self._table.shape, unlimited=True
        )
        torque = checks.finite_array("torque", present(arrays, "torque"), self._torque.shape)
        state = checks.finite_array("state", present(arrays, "state"), self._state.shape)
        lost = int(np.asarray(present(arrays, "lost")))
        started = bool(np.asarray(present(arrays, "started")))
        self.broken = str(present(arrays, "broken")) or None
        self._table[:], self._torque[:], self._state[:] = table, torque, state
        self._lost, self.has_started = lost, started

    def _link(self) -> None:
        """Make what only refers to other memory: Pinocchio's scratch memory, views, the code."""
        self._model, self._data = self.arm.model, self.arm.model.createData()
        self._M, self._h = self._data.M.T, self._data.nle
        self._q, self._v = self._state[0, : self.arm.nq], self._state[1, : self.arm.nv]
        self._sent, _, self._added = self._torque
        ahead = (rows.WAY, rows.LATE_V, rows.PLACE, rows.PENDING)
        self._ahead = tuple(self._table[row] for row in ahead)
        nq, own = self.arm.nq, (self._state, self._places, self._table)
        restricted(read_state, self._dt, np.zeros(1), np.zeros(1), nq, *own)
        terms = (self._M, self._h, self._h)
        self._filtered = specialized(
            filtered, self._dt, self._sent, *terms, False, self._torque, self._work, self._table
        )
