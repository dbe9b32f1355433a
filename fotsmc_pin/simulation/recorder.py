"""`Recorder`: a recording while it grows."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.compiled import kernel, specialized
from fotsmc_pin.simulation.recording import Recording

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation.events import PlantChange
    from fotsmc_pin.simulation.plant import Plant
    from fotsmc_pin.simulation.wrench import Wrench
    from fotsmc_pin.types import Array


class Recorder:
    """Rows of state, torque and the controller's signals, and the reference beside them.

    A row is copied in one call from the arrays in which the plant and the controller keep these
    numbers: a controller's `live_signals`, where they are vectors in one piece. Others are copied
    one by one, and where a controller has no such arrays its `signals` are read at each row.
    """

    def __init__(
        self,
        arm: Arm,
        plant: Plant,
        controller: object,
        *,
        instants: Array,
        stride: int,
        readings: tuple[str, ...] = (),
    ) -> None:
        """Allocate a row for every `stride`-th of the ticks at `instants` [s].

        `readings` names what sensors measure: fields of the recording that it has only then.
        """
        self._arm, self._controller, self._stride, self._filled = arm, controller, stride, 0
        self._t = instants[::stride].copy()
        size = len(self._t)
        self._q_d, self._v_d = np.zeros((size, arm.nq)), np.zeros((size, arm.nv))
        self._resolved: tuple[Array, Array] | None = getattr(controller, "resolved", None)
        shown = getattr(controller, "signals", {})
        own = getattr(controller, "live_signals", {})
        self._own_signals, live = own, {**own, **plant.live_signals}
        self._names = tuple(name for name in shown if is_flat(live.get(name)))
        self._names = tuple(dict.fromkeys((*self._names, *plant.live_signals)))
        self._asked = {
            name: np.zeros((size, np.size(value)))
            for name, value in shown.items()
            if name not in self._names
        }
        self._widths = [arm.nq, arm.nv, arm.nv, *(live[name].size for name in self._names)]
        self._live = (*plant.live, *(live[name] for name in self._names))
        self._table = np.zeros((size, sum(self._widths)))
        widths = {"q_measured": arm.nq, "v_measured": arm.nv, "tau_measured": arm.nv}
        self._readings = {name: np.zeros((size, widths[name])) for name in readings}
        self._note = specialized(note, self._table, 0, self._live)

    def write_reference(self, tick: int, q_d: Array, v_d: Array) -> None:
        """Write the reference of the ticks from `tick` on, a row each."""
        stride = self._stride
        skipped = -tick % stride
        rows = slice((tick + skipped) // stride, (tick + len(q_d) - 1) // stride + 1)
        self._q_d[rows], self._v_d[rows] = q_d[skipped::stride], v_d[skipped::stride]

    def write_row(self, *readings: Array) -> None:
        """Write the next row, with what the sensors read."""
        k = self._filled
        self._note(self._table, k, self._live)
        if self._resolved is not None:
            self._q_d[k], self._v_d[k] = self._resolved
        for rows, reading in zip(self._readings.values(), readings, strict=True):
            rows[k] = reading
        if self._asked:
            signals = self._own_signals or self._controller.signals  # type: ignore[attr-defined]
            for name, rows in self._asked.items():
                rows[k] = signals[name]
        self._filled = k + 1

    def recording(
        self,
        metadata: dict[str, Any],
        *,
        events: Sequence[PlantChange] = (),
        wrenches: Sequence[Wrench] = (),
    ) -> Recording:
        """Return all rows so far; its arrays are views on the recorder's table, not copies.

        Of `events` and `wrenches` those are kept that the run has reached.
        """
        n = self._filled
        reached = float(self._t[n - 1]) if n else -1.0
        ends = np.cumsum([0, *self._widths]).tolist()
        parts = [self._table[:n, start:end] for start, end in pairwise(ends)]
        (q, v, tau), live = parts[:3], dict(zip(self._names, parts[3:], strict=True))
        q_d, v_d = self._q_d[:n], self._v_d[:n]
        asked = {name: rows[:n] for name, rows in self._asked.items()}
        return Recording(
            t=self._t[:n],
            q=q,
            v=v,
            q_d=q_d,
            v_d=v_d,
            e=tracking_errors(self._arm, q_d, q),
            e_dot=v - v_d,
            tau=tau,
            signals=live | asked,
            **{name: rows[:n] for name, rows in self._readings.items()},
            arm=self._arm,
            metadata=metadata,
            events=tuple(event for event in events if event.time <= reached),
            wrenches=tuple(wrench for wrench in wrenches if wrench.start <= reached),
        )


def is_flat(signal: object) -> bool:
    """Return whether a signal is a plain vector of floats, which `note` copies."""
    return (
        isinstance(signal, np.ndarray)
        and signal.dtype == np.float64
        and signal.ndim == 1
        and signal.flags.c_contiguous
        and signal.flags.writeable
    )


def tracking_errors(arm: Arm, q_d: Array, q: Array) -> Array:
    """Return the tracking errors `q ⊖ q_d` (N, nv) of all rows."""
    if arm.is_euclidean:
        return q - q_d
    rows = [pin.difference(arm.model, *row) for row in zip(q_d, q, strict=True)]
    return np.array(rows).reshape(len(rows), arm.nv)


@kernel
def note(table: Array, row: int, parts: tuple[Array, ...]) -> None:
    """Write the parts one after the other into a row of `table`."""
    start = 0
    for part in parts:
        for k in range(part.size):
            table[row, start + k] = part[k]
        start += part.size
