"""`Run`: what a run on a robot gives, and its rows while it goes on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.simulation.journal import Journal
from fotsmc_pin.simulation.measured_run import measured_run
from fotsmc_pin.simulation.recorder import is_flat
from fotsmc_pin.simulation.simulate import run_metadata

if TYPE_CHECKING:
    import os

    from fotsmc_pin.control import Safeguard
    from fotsmc_pin.realtime.robot import Robot
    from fotsmc_pin.realtime.timing import Timing
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array, PoseReference, Reference


@dataclass(frozen=True, kw_only=True)
class Run:
    """A run on a robot.

    Attributes:
        recording: what was measured, wanted and sent. Its times are the measured ones; its `q` and
            `v` are what the robot read, and its arm is the nominal one, as nothing else is known.
            `tau` is the total torque, with what the drives add by their declaration, and signal
            "sent" what was commanded; `tau_measured` is there where the robot measures torques.
            Signal "period" is the measured one [s], and "stopping" is 1 where the safe stop was on.
            The metadata tell why it was "stopped".
        timing: how well the loop kept its time.
    """

    recording: Recording
    timing: Timing

    def __str__(self) -> str:
        """Return the timing, to print."""
        return str(self.timing)


class RunRecorder:
    """Writes a row per tick, and makes a recording of them."""

    def __init__(
        self,
        controller: Safeguard,
        robot: Robot,
        reference: Reference | PoseReference,
        duration: float,
        *,
        size: int,
        path: str | os.PathLike[str] | None,
    ) -> None:
        """Make room for `size` rows, in the file `path` or in memory."""
        self._controller, self._path = controller, None if path is None else Path(path)
        arm = self._arm = controller.arm
        self._read_torque = getattr(robot, "read_torque", None)
        self._resolved = controller.resolved
        live = controller.live_signals
        names = tuple(name for name in controller.signals if is_flat(live.get(name)))
        self._live = tuple(live[name] for name in names)
        self._head = np.zeros(3)
        self._columns = {"t": 1, "period": 1, "stopping": 1, "q": arm.nq, "v": arm.nv}
        self._columns |= {"q_d": arm.nq, "v_d": arm.nv, "tau": arm.nv, "sent": arm.nv}
        if self._read_torque is not None:
            self._columns["tau_measured"] = arm.nv
        felt = sum(self._columns.values())
        self._felt = slice(felt - arm.nv, felt)
        self._columns |= {name: part.size for name, part in zip(names, self._live, strict=True)}
        options = {
            "duration": duration,
            "robot": type(robot).__name__,
            "compensates": list(controller.compensates),
            "paced": robot.paced,
        }
        self._metadata = run_metadata(controller.controller, reference, options, 0.0)
        about = {"arm": arm.to_dict(), "metadata": self._metadata, "columns": self._columns}
        width = sum(self._columns.values())
        self._journal = Journal(self._path, about, size, width)
        self._width = width
        self._reason: str | None = None

    def write_row(
        self, t: float, period: float, q: Any, v: Any, target: tuple[Any, ...], tau: Array
    ) -> None:
        """Write the row of a tick that was just sent.

        A controller that follows poses has resolved them to what the joints are to do.
        A torque that is measured now is that of the row before, whose torque acted until now.
        """
        controller, journal, k = self._controller, self._journal, self._journal.filled
        self._head[:] = t, period, controller.stopped is not None
        wanted = target[:2] if self._resolved is None else self._resolved
        parts = [self._head, q, v, *wanted, tau, controller.sent]
        if self._read_torque is not None:
            felt = self._read_torque()
            parts.append(felt)
            if k:
                journal.table[k - 1, self._felt] = felt
        np.concatenate((*parts, *self._live), out=journal.table[k, : self._width])
        journal.end_row()
        if controller.stopped != self._reason:
            self._reason = controller.stopped
            journal.note_reason(controller.stopped or "")

    def recording(self, timing: Timing) -> Recording:
        """Return the recording, and write it in place of the journal where there is a file."""
        rows = self._journal.table[: self._journal.filled, :-1]
        wall_time = float(rows[-1, 0]) if len(rows) else 0.0
        told = {"stopped": timing.stopped, "timing": timing.as_dict(), "wall_time": wall_time}
        rec = measured_run(self._arm, self._columns, rows, self._metadata | told)
        if self._path is not None:
            rec.save(self._path)
        return rec
