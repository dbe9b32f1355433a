"""`Controller`: one tick of control, the face that every law shares."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel, settled, strict
from fotsmc_pin.control.saturation import clip
from fotsmc_pin.errors import ArgumentError, MeasurementError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array, Gains
    from fotsmc_pin.fractional import Stream

LARGEST = 1e8
"""Positions, speeds and accelerations beyond this are taken as this, so that nothing overflows."""

SHORTEST_TICK, LONGEST_TICK = 1e-3, 1e6
"""Measured periods of a tick are refused outside these multiples of the nominal one."""

ROUNDNESS = 1e-3
"""How far the cosine and sine of a continuous joint may lie from the unit circle."""

E, ED, V, V_D, A_D, TAU, LIMIT = range(7)
"""Rows of a controller's `joints`: `e`, `ė`, `v`, `v_d`, `a_d`, the torque and its limit."""


class Controller(ABC):
    """A control law bound to a nominal arm and a tick of `dt` seconds.

    A law declares its `Gains` and `presets`, allocates its memory in `_prepare`, and names the
    `_kernel` of one tick, which reads `_joints`, `_M0` and `_h0` and writes the torque into
    `_joints[TAU]`. It is compiled when the controller is made, so that the first tick takes no
    longer than the others.

    Attributes:
        arm: the nominal arm; the plant is never seen.
        dt: nominal period of a tick [s].
        preset: name of the set of gains that was started from.
        gains: the gains in force, checked, one entry per joint where the law has it so.
    """

    Gains: ClassVar[type[Gains]]
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {"default": {}}
    representative: ClassVar[bool] = False
    """The law stands for one whose source could not be found."""

    def __init__(self, arm: Arm, dt: float, *, preset: str | None = None, **gains: Any) -> None:
        """Check the gains and allocate the memory.

        Args:
            arm: nominal arm, whose model the law uses.
            dt: period of a tick [s].
            preset: name in `presets`; the first one by default.
            **gains: single gains that differ from the preset, by name.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        self.arm = arm
        self.dt = checks.finite_number("dt", dt, above=0.0)
        self.preset = checks.choice("preset", preset or next(iter(self.presets)), [*self.presets])
        self.gains: Any = self.Gains.resolve(arm.nv, self.presets[self.preset], gains)
        self._model, self._data = arm.model, arm.model.createData()
        self._euclidean = arm.is_euclidean
        self._configurations = np.zeros((2, arm.nq))
        self._q, self._q_d = self._configurations
        self._joints = np.zeros((7, arm.nv))
        self._joints[LIMIT] = arm.effort_limit
        self._v: Array = self._joints[V]
        self._tau: Array = self._joints[TAU]
        # Live views on Pinocchio's results. M0 is symmetric: its transpose is itself, in C order.
        self._M0: Array = self._data.M.T
        self._h0: Array = self._data.nle
        self._streams: list[Stream] = []
        self._state = np.zeros(0)
        self._signals: dict[str, Array] = {}
        self._arguments: tuple[Any, ...] = ()
        self._prepare()
        self._initial_state = self._state.copy()
        self._code = settled(self._kernel, self.dt, *self._arguments)
        q, v = self._q, self._v
        strict(take, q, v, q, v, v, self._configurations, self._joints)

    @abstractmethod
    def _prepare(self) -> None:
        """Allocate `_streams`, `_state` and `_signals`; gather the kernel's `_arguments`."""

    @property
    @abstractmethod
    def _kernel(self) -> Kernel:
        """The law: a kernel of `dt` and the `_arguments`.

        It writes the torque, within the effort limits, and advances the memory by one tick.
        """

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
            taken = take(q, v, q_d, v_d, a_d, self._configurations, self._joints)  # type: ignore[arg-type]
        except (AttributeError, TypeError):  # not plain arrays of floats
            taken = False
        if not taken:
            self._take_with_care(q, v, q_d, v_d, a_d)
        if not self._euclidean:
            self._take_difference(q, q_d)
        if dt is None:
            dt = self.dt
        else:
            shortest, longest = SHORTEST_TICK * self.dt, LONGEST_TICK * self.dt
            dt = checks.finite_number("dt", dt, at_least=shortest, at_most=longest)
        self._model_terms()
        self._code(dt, *self._arguments)
        return self._tau.copy()

    def _pack(self, *values: Array | float) -> Array:
        """Return gains as the rows of one array, a column per joint, for the kernel."""
        return np.array([np.broadcast_to(value, self.arm.nv) for value in values])

    def _model_terms(self) -> None:
        """Evaluate the nominal model: `M0(q)` and `h0 = C0(q, v) v + G0(q)`."""
        pin.crba(self._model, self._data, self._q)
        pin.nonLinearEffects(self._model, self._data, self._q, self._v)

    @property
    def signals(self) -> dict[str, Array]:
        """Copies of the last tick's inner signals by name, such as "s"."""
        return {name: signal.copy() for name, signal in self._signals.items()}

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew: for reading, by a recorder."""
        return self._signals

    def reset(self) -> None:
        """Forget everything: the controller is as it was when it was made."""
        for stream in self._streams:
            stream.reset()
        self._state[:] = self._initial_state
        self._tau[:] = 0.0
        for signal in self._signals.values():
            if not np.shares_memory(signal, self._state):
                signal[:] = 0.0

    def __repr__(self) -> str:
        """Name the law, the arm, the period and the gains."""
        gains = ", ".join(f"{name}={value}" for name, value in self.gains.as_dict().items())
        return f"{type(self).__name__}({self.arm.name}, dt={self.dt:g}, {gains})"

    def _take_with_care(self, *values: ArrayLike) -> None:
        """Take lists, whole numbers and strided arrays too, or say which argument is at fault."""
        nq, nv = self.arm.nq, self.arm.nv
        names, sizes = ("q", "v", "q_d", "v_d", "a_d"), (nq, nv, nq, nv, nv)
        clean = []
        for name, value, size in zip(names, values, sizes, strict=True):
            try:
                clean.append(checks.finite_vector(name, value, size))
            except ArgumentError as error:
                raise MeasurementError(name, value, error.remedy) from None
        q, v, q_d, v_d, a_d = clean
        take(q, v, q_d, v_d, a_d, self._configurations, self._joints)

    def _take_difference(self, q: ArrayLike, q_d: ArrayLike) -> None:
        """Take `e = q ⊖ q_d` of an arm with continuous joints, whose `q` are no plain vector."""
        for name, value, taken in (("q", q, self._q), ("q_d", q_d, self._q_d)):
            if not pin.isNormalized(self._model, taken, ROUNDNESS):
                remedy = "give the cosine and sine of each continuous joint"
                raise MeasurementError(name, value, remedy)
        self._joints[E] = pin.difference(self._model, self._q_d, self._q)


@kernel
def take(
    q: Array,
    v: Array,
    q_d: Array,
    v_d: Array,
    a_d: Array,
    configurations: Array,
    joints: Array,
) -> bool:
    """Copy the arguments of a tick, each number kept below `LARGEST`; fill in `e` and `ė`.

    `e` is that of plain joints, whose difference is that of their numbers. Returns whether every
    array has its shape and every number is finite.
    """
    nq, nv = configurations.shape[1], joints.shape[1]
    if not (q.shape == q_d.shape == (nq,) and v.shape == v_d.shape == a_d.shape == (nv,)):
        return False
    for k in range(nq):
        if not (math.isfinite(q[k]) and math.isfinite(q_d[k])):
            return False
        configurations[0, k], configurations[1, k] = clip(q[k], LARGEST), clip(q_d[k], LARGEST)
    for j in range(nv):
        if not (math.isfinite(v[j]) and math.isfinite(v_d[j]) and math.isfinite(a_d[j])):
            return False
        joints[E, j] = configurations[0, j] - configurations[1, j]
        joints[V, j] = clip(v[j], LARGEST)
        joints[V_D, j] = clip(v_d[j], LARGEST)
        joints[A_D, j] = clip(a_d[j], LARGEST)
        joints[ED, j] = joints[V, j] - joints[V_D, j]
    return True
