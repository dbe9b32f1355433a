"""`Controller`: one tick of control, the face that every law shares."""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping
from itertools import chain
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeAlias

import numpy as np
import pinocchio as pin
from typing_extensions import TypeVar

from fotsmc_pin import checks
from fotsmc_pin.arms import Arm, demand_arm
from fotsmc_pin.compiled import restricted, specialized
from fotsmc_pin.control.arguments import cleaned_arguments, demand_round, read_arguments
from fotsmc_pin.control.conditions import warn_of_gravity, warn_of_slow_ticks
from fotsmc_pin.control.declaration import check_declaration
from fotsmc_pin.control.friction_terms import are_own, terms_of
from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import NoRows, new_table, rows, signal_views
from fotsmc_pin.control.saved_state import restore, saved
from fotsmc_pin.copying import SharesNothing
from fotsmc_pin.notebook import page_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.model_terms import ModelTerms
    from fotsmc_pin.fractional import FractionalOperator, Stream
    from fotsmc_pin.types import Array

G = TypeVar("G", bound=Gains, default=Any)
Streams: TypeAlias = "Mapping[str, Callable[[Any, float], FractionalOperator]]"
SignalRows: TypeAlias = Mapping[str, str | tuple[str, ...]]

SHORTEST_TICK, LONGEST_TICK = 1e-3, 1e6
"""Measured periods of a tick are refused outside these multiples of the nominal one."""


class Controller(SharesNothing, ABC, Generic[G]):
    """A control law bound to a nominal arm and a tick of `dt` seconds.

    A law declares what it is made of, in the class attributes below, and one kernel, `tick`. The
    rest is done here: arguments are checked, the nominal model is evaluated, and the memory is
    allocated, handed to the kernel, forgotten, saved and copied. The kernel is compiled when the
    controller is made, so that the first tick takes no longer than the others.

    A controller is an ordinary object: `copy`, `deepcopy` and `pickle` give an independent twin
    that goes on bit for bit.

    Class attributes:
        Gains: the law's gains, with their bounds.
        State: rows that live on from tick to tick, zero at the start.
        Work: rows that a tick fills anew.
        streams: the fractional operators, by name, each a function of the gains and `dt`.
        signal_rows: which row of `State` or `Work` is shown under which name; several rows that
            hold one number each are shown as one vector.
        torque_rows: rows of `State` that hold torques; of a coupled arm one joint's error moves all
            entries of those, which whoever linearises the law must know.
        presets: sets of gains by name; the first one is the default.
        representative: the law stands for one whose source could not be found.
        uses_model: whether the tick reads `M0` and `h0`, which are then evaluated.
        tick: the law, `tick(dt, table, M0, h0, ...)`, and for each stream its `coefficients` and
            `memory`. It names the rows of the table by `rows`, writes the torque `tau` within the
            effort limits, and advances the memory by one tick.

    Attributes:
        arm: the nominal arm; the plant is never seen.
        dt: nominal period of a tick [s].
        preset: name of the set of gains that was started from.
        gains: the gains in force, checked, one entry per joint where the law has it so.
        q: live configuration that the last tick was given (nq,); for authors of laws.
        joints: live rows of what a tick brings and gives, by name; for authors of laws.
        state: live rows of `State`, by name; for authors of laws.
        memories: the running streams, by name; for authors of laws.
    """

    linked: ClassVar[frozenset[str]] = frozenset(
        {
            *("_terms", "model_terms", "_euclidean", "q", "_q_d", "_tau"),
            *("joints", "state", "_work", "_signals", "_arguments", "_code"),
        }
    )
    Gains: ClassVar[type[Gains]]
    State: ClassVar[type] = NoRows
    Work: ClassVar[type] = NoRows
    streams: ClassVar[Streams] = {}
    signal_rows: ClassVar[SignalRows] = {}
    torque_rows: ClassVar[tuple[str, ...]] = ()
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {"default": {}}
    representative: ClassVar[bool] = False
    uses_model: ClassVar[bool] = True
    _feeds_friction = True
    tick: ClassVar[Callable[..., None]]

    gains: G
    state: Any

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        check_declaration(cls)

    def __init__(self, arm: Arm, dt: float, *, preset: str | None = None, **gains: Any) -> None:
        """Check the gains and allocate the memory.

        Args:
            arm: nominal arm, whose model the law uses.
            dt: period of a tick [s].
            preset: name in `presets`; the first one by default.
            **gains: single gains that differ from the preset, by name.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
            UrdfError: a joint of the arm moves no inertia, so that it has no dynamics.
        """
        demand_arm(arm)
        self.arm = arm
        self.dt = checks.finite_number("dt", dt, above=0.0)
        self.preset = checks.choice("preset", preset or next(iter(self.presets)), [*self.presets])
        self.gains = self.Gains.resolve(arm, self.dt, self.presets[self.preset], gains)  # type: ignore[assignment]
        self._configurations = np.zeros((2, arm.nq))
        gains_in_force = self.effective_gains()
        self._table = new_table(gains_in_force, self.State, self.Work, arm.effort_limit)
        self.memories: dict[str, Stream] = {
            name: operator(gains_in_force, self.dt).stream(arm.nv)
            for name, operator in self.streams.items()
        }
        self._link()
        self.review()
        self.reset()

    def review(self) -> None:
        """Warn of what the arm or the gains make impossible; called once, when both stand."""
        warn_of_gravity(self.arm, self)
        warn_of_slow_ticks(self.effective_gains(), self.dt, self)

    def effective_gains(self) -> G:
        """Return the gains that the tick and the streams are made with; `gains` by default."""
        return self.gains

    def start(self) -> None:
        """Fill in what the memory starts from, where that is not zero; called by `reset`."""

    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        q_d: ArrayLike,
        v_d: ArrayLike,
        a_d: ArrayLike,
        dt: float | None = None,
    ) -> Array:
        """Advance by one tick.

        Args:
            q: measured configuration (nq,) [rad, m].
            v: measured velocity (nv,) [rad/s, m/s].
            q_d: reference configuration (nq,) [rad, m].
            v_d: reference velocity (nv,) [rad/s, m/s].
            a_d: reference acceleration (nv,) [rad/s², m/s²].
            dt: measured time since the last tick [s]; the nominal one if None.

        Returns:
            Torque (nv,) [N·m, N]: finite, and within the arm's effort limits.

        Raises:
            MeasurementError: an argument has the wrong shape or is not finite. The memory of the
                controller is as it was, and the next good tick goes on from there.
        """
        try:
            are_read = read_arguments(q, v, q_d, v_d, a_d, self._configurations, self._table)  # type: ignore[arg-type]
        except (AttributeError, TypeError):  # not plain arrays of floats
            are_read = False
        if not are_read:
            clean = cleaned_arguments(self.arm.nq, self.arm.nv, q, v, q_d, v_d, a_d)
            read_arguments(*clean, self._configurations, self._table)  # type: ignore[call-arg]
        if not self._euclidean:
            demand_round(self.arm, "q", q, self.q)
            demand_round(self.arm, "q_d", q_d, self._q_d)
            self.joints.e[:] = pin.difference(self.arm.model, self._q_d, self.q)
        if dt is None:
            dt = self.dt
        else:
            shortest, longest = SHORTEST_TICK * self.dt, LONGEST_TICK * self.dt
            dt = checks.finite_number("dt", dt, at_least=shortest, at_most=longest)
        if self.uses_model:
            self._terms.evaluate(self.q, self.joints)
        self._code(dt, *self._arguments)
        tau: Array = self._tau.copy()
        return tau

    def note_applied(self, tau: Array, friction: Array) -> None:
        """Take note of the torque that acts from the last tick on, where it is another than asked.

        Observers work with it. A part that was added against friction is left out: a law's model
        has no friction, so it is the rest that moves the arm.

        Args:
            tau: the total torque (nv,) [N·m, N].
            friction: the part of it that was added against friction (nv,).
        """
        self._tau[:] = tau
        self._tau -= friction

    def reset(self) -> None:
        """Forget everything: the controller is as it was when it was made."""
        for stream in self.memories.values():
            stream.reset()
        self._tau[:] = self.joints.tau_extra[:] = 0.0
        for row in (*self.state, *self._work):
            row[:] = 0.0
        self.start()

    @property
    def signals(self) -> dict[str, Array]:
        """Copies of the last tick's inner signals by name, such as "s"."""
        return {name: signal.copy() for name, signal in self._signals.items()}

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew: for reading, by a recorder."""
        return self._signals

    def save_state(self) -> dict[str, Array]:
        """Return everything that the controller remembers, as plain arrays by name.

        Given to `restore_state` of a controller with the same arm, tick and gains, it goes on from
        there bit for bit, in another process too.
        """
        return saved(self._remembered, self.memories)

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing, unknown, of the wrong shape or not finite. The
                memory stays as it was.
        """
        restore(arrays, self._remembered, self.memories)
        self._link()

    @property
    def _remembered(self) -> dict[str, Any]:
        return {"joints": self.joints, "state": self.state, "work": self._work}

    def __repr__(self) -> str:
        """Name the law, the arm, the period and the gains."""
        gains = ", ".join(f"{name}={value}" for name, value in self.gains.as_dict().items())
        return f"{type(self).__name__}({self.arm.name}, dt={self.dt:g}, {gains})"

    _repr_html_ = page_of

    def _link(self) -> None:
        """Make what only refers to the arrays: the named rows, Pinocchio's memory, the code."""
        self._euclidean = self.arm.is_euclidean
        self.q, self._q_d = self._configurations
        named: tuple[Any, ...] = rows(self._table, self.Gains, self.State, self.Work)
        self.joints, _, self.state, self._work = named
        self._tau = self.joints.tau
        self._signals = signal_views(
            self._table, self.Gains, self.State, self.Work, self.signal_rows
        )
        self.use_terms(terms_of(self.arm, feeds_friction=self._feeds_friction))
        q, v = self.q, self.joints.v
        restricted(read_arguments, q, v, q, v, v, self._configurations, self._table)

    def use_terms(self, terms: ModelTerms) -> None:
        """Evaluate `M0` and `h0` by `terms` from now on, in place of the arm's own model.

        For wrappers; a copy of the controller goes back to the arm's own.
        """
        self._terms = terms
        self.model_terms = terms if self.uses_model else None
        # Copies of the coefficients: a kernel is compiled once more for arrays that are read-only.
        streams = [(s.coefficients.copy(), s.memory) for s in self.memories.values()]
        self._arguments = (self._table, terms.M, terms.h, *chain(*streams))
        self._code = specialized(self.tick, self.dt, *self._arguments)

    def feed_friction(self, wanted: bool) -> None:
        """Feed friction that is known forward, or leave it to drives that compensate it."""
        self._feeds_friction = wanted
        if are_own(self._terms):
            self.use_terms(terms_of(self.arm, feeds_friction=wanted))

    def keep_nominal_model(self) -> None:
        """Work with the nominal model whatever is learnt, as a law by itself always does."""

    @property
    def compiled(self) -> tuple[Callable[..., None], tuple[Any, ...]]:
        """The tick as machine code and what it takes after `dt`, for wrappers that fill the rows.

        Both change when the terms do, or the state is restored.
        """
        return self._code, self._arguments
