"""`Recorder`: a recording while it grows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import pinocchio as pin

from fotsmc_pin.compiled import kernel, strict
from fotsmc_pin.simulation.recording import Recording

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm

    Array = NDArray[np.float64]


class State(Protocol):
    """What is recorded of a plant: live arrays."""

    q: Array
    v: Array
    tau: Array


class Recorder:
    """Rows of state, reference, torque and the controller's signals, one for each recorded tick.

    A controller's `live_signals`, arrays that each tick writes anew, are read where it has them;
    otherwise its `signals`, which may cost a copy each.
    """

    def __init__(self, arm: Arm, t: Array, controller: object) -> None:
        """Make room for a row at each time in `t`."""
        self._arm, self._t, self._controller, self._filled = arm, t, controller, 0
        # Columns: q, v, q_d, v_d, tau.
        self._table = np.zeros((len(t), 2 * arm.nq + 3 * arm.nv))
        strict(note, *6 * [self._table[0]])
        self._signals = {
            name: np.zeros((len(t), np.size(value)))
            for name, value in getattr(controller, "signals", {}).items()
        }
        live = getattr(controller, "live_signals", {})
        self._live = [(self._signals[name], signal) for name, signal in live.items()]

    def add(self, plant: State, q_d: Array, v_d: Array) -> None:
        """Write the next row."""
        k = self._filled
        row = self._table[k]
        try:
            note(row, plant.q, plant.v, q_d, v_d, plant.tau)
        except TypeError:  # a reference of lists, or of other kinds of numbers
            q_d, v_d = np.array(q_d, dtype=np.float64), np.array(v_d, dtype=np.float64)
            note(row, plant.q, plant.v, q_d, v_d, plant.tau)
        for rows, signal in self._live:
            rows[k] = signal
        if self._signals and not self._live:
            for name, value in self._controller.signals.items():  # type: ignore[attr-defined]
                self._signals[name][k] = value
        self._filled = k + 1

    def recording(self, metadata: dict[str, Any]) -> Recording:
        """Return all rows so far."""
        n, nq, nv = self._filled, self._arm.nq, self._arm.nv
        parts = np.split(self._table[:n], np.cumsum([nq, nv, nq, nv]), axis=1)
        q, v, q_d, v_d, tau = map(np.ascontiguousarray, parts)
        return Recording(
            t=self._t[:n],
            q=q,
            v=v,
            q_d=q_d,
            v_d=v_d,
            e=errors(self._arm, q_d, q),
            ed=v - v_d,
            tau=tau,
            signals={name: rows[:n] for name, rows in self._signals.items()},
            arm=self._arm,
            metadata=metadata,
        )


def errors(arm: Arm, q_d: Array, q: Array) -> Array:
    """Return the tracking errors `q ⊖ q_d` (N, nv) of all rows."""
    if arm.is_euclidean:
        return q - q_d
    rows = [pin.difference(arm.model, *row) for row in zip(q_d, q, strict=True)]
    return np.array(rows).reshape(len(rows), arm.nv)


@kernel
def note(row: Array, q: Array, v: Array, q_d: Array, v_d: Array, tau: Array) -> None:
    """Write the parts one after the other into `row`."""
    start = 0
    for part in (q, v, q_d, v_d, tau):
        for k in range(len(part)):
            row[start + k] = part[k]
        start += len(part)
