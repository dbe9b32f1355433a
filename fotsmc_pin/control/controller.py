"""`Controller`: one tick of control, the face that every law shares."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.saturation import clip
from fotsmc_pin.errors import ArgumentError, MeasurementError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gains import Array, Gains
    from fotsmc_pin.fractional import Stream

LARGEST = 1e8
"""Positions, speeds and accelerations beyond this are taken as this, so that nothing overflows."""

SHORTEST_TICK, LONGEST_TICK = 1e-3, 1e6
"""Measured periods of a tick are refused outside these multiples of the nominal one."""

ROUNDNESS = 1e-3
"""How far the cosine and sine of a continuous joint may lie from the unit circle."""

E, ED, V, V_D, A_D = range(5)
"""Rows of a controller's `motion`: `e`, `ė`, `v`, `v_d`, `a_d`."""


class Controller(ABC):
    """A control law bound to a nominal arm and a tick of `dt` seconds.

    A law declares its `Gains` and `presets`, allocates its memory in `_prepare`, and computes one
    tick in `_law`, which reads `_motion`, `_M0` and `_h0` and writes `_tau`.

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
        self._q, self._q_d = np.zeros(arm.nq), np.zeros(arm.nq)
        self._motion = np.zeros((5, arm.nv))
        self._tau = np.zeros(arm.nv)
        self._effort_limit = np.array(arm.effort_limit)
        # Live views on Pinocchio's results. M0 is symmetric: its transpose is itself, in C order.
        self._M0: Array = self._data.M.T
        self._h0: Array = self._data.nle
        self._streams: list[Stream] = []
        self._state = np.zeros(0)
        self._signals: dict[str, Array] = {}
        self._arguments: tuple[Any, ...] = ()
        self._prepare()
        self._initial_state = self._state.copy()

    @abstractmethod
    def _prepare(self) -> None:
        """Allocate `_streams`, `_state` and `_signals`; gather the kernel's `_arguments`."""

    @abstractmethod
    def _law(self, dt: float) -> None:
        """Write `_tau`, within the effort limits, and advance the memory by one tick."""

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
        motion = self._motion
        try:
            self._take(self._q, q)
            self._take(motion[V], v)
            self._take(self._q_d, q_d)
            self._take(motion[V_D], v_d)
            self._take(motion[A_D], a_d)
        except (TypeError, ValueError):
            raise self._fault(q, v, q_d, v_d, a_d) from None
        if not usable(self._q, self._q_d, motion) or not (self._euclidean or self._on_circles()):
            raise self._fault(q, v, q_d, v_d, a_d)
        if dt is None:
            dt = self.dt
        else:
            shortest, longest = SHORTEST_TICK * self.dt, LONGEST_TICK * self.dt
            dt = checks.finite_number("dt", dt, at_least=shortest, at_most=longest)
        motion[E] = pin.difference(self._model, self._q_d, self._q)
        self._model_terms()
        self._law(dt)
        return self._tau.copy()

    def _pack(self, *values: Array | float) -> Array:
        """Return gains as the rows of one array, a column per joint, for the kernel."""
        return np.array([np.broadcast_to(value, self.arm.nv) for value in values])

    def _model_terms(self) -> None:
        """Evaluate the nominal model: `M0(q)` and `h0 = C0(q, v) v + G0(q)`."""
        pin.crba(self._model, self._data, self._q)
        pin.nonLinearEffects(self._model, self._data, self._q, self._motion[V])

    @property
    def signals(self) -> dict[str, Array]:
        """Copies of the last tick's inner signals by name, such as "s"."""
        return {name: signal.copy() for name, signal in self._signals.items()}

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

    @staticmethod
    def _take(buffer: Array, value: ArrayLike) -> None:
        # The shape is compared first: assignment alone would broadcast.
        if getattr(value, "shape", None) != buffer.shape and np.shape(value) != buffer.shape:
            raise ValueError
        buffer[:] = value

    def _fault(self, *values: ArrayLike) -> MeasurementError:
        """Find the argument that is at fault."""
        nq, nv = self.arm.nq, self.arm.nv
        names, sizes = ("q", "v", "q_d", "v_d", "a_d"), (nq, nv, nq, nv, nv)
        for name, value, size in zip(names, values, sizes, strict=True):
            try:
                checks.finite_vector(name, value, size)
            except ArgumentError as error:
                return MeasurementError(name, value, error.remedy)
        name, value = ("q_d", values[2]) if self._on_circle(self._q) else ("q", values[0])
        return MeasurementError(name, value, "give the cosine and sine of each continuous joint")

    def _on_circles(self) -> bool:
        """Return whether the continuous joints of `q` and `q_d` are cosines and sines."""
        return self._on_circle(self._q) and self._on_circle(self._q_d)

    def _on_circle(self, q: Array) -> bool:
        return bool(pin.isNormalized(self._model, q, ROUNDNESS))


@kernel
def usable(q: Array, q_d: Array, motion: Array) -> bool:
    """Return whether all is finite; keep it below `LARGEST` and fill in `ė = v - v_d`."""
    for k in range(q.size):
        if not (math.isfinite(q[k]) and math.isfinite(q_d[k])):
            return False
        q[k], q_d[k] = clip(q[k], LARGEST), clip(q_d[k], LARGEST)
    for j in range(motion.shape[1]):
        for row in (V, V_D, A_D):
            if not math.isfinite(motion[row, j]):
                return False
            motion[row, j] = clip(motion[row, j], LARGEST)
        motion[ED, j] = motion[V, j] - motion[V_D, j]
    return True
