"""`Recording`: everything that happened in a run, time first, with the true arm."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms import Arm
from fotsmc_pin.errors import RecordingError
from fotsmc_pin.files import replacing
from fotsmc_pin.notebook import page_of
from fotsmc_pin.progress import reporting
from fotsmc_pin.simulation import recording_file
from fotsmc_pin.simulation.events import PlantChange
from fotsmc_pin.simulation.journal import MAGIC, is_journal
from fotsmc_pin.simulation.wrench import Wrench

if TYPE_CHECKING:
    import os

    from fotsmc_pin.progress import Progress
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, repr=False)
class Recording:
    """A run of `N` ticks: state, reference, error, torque and the controller's signals.

    Row `k` of each array belongs to the tick at `t[k]`: the state that the plant was in, the
    reference, and the torque that was applied from then on.

    Attributes:
        t: time (N,) [s].
        q: true configuration (N, nq) [rad, m; cos and sin for a continuous joint].
        v: true velocity (N, nv) [rad/s, m/s].
        q_d: reference configuration (N, nq).
        v_d: reference velocity (N, nv).
        e: tracking error `q ⊖ q_d` (N, nv) [rad, m].
        e_dot: velocity error `v - v_d` (N, nv) [rad/s, m/s].
        tau: torque at the joints, after all limits (N, nv) [N·m, N].
        signals: named arrays (N, k) of the controller, such as "s", its sliding variable; of an arm
            with elastic joints also "deflection", motor beyond link, and "motor_speed".
        q_measured: configuration that the sensors gave the controller (N, nq); None without a
            sensor, where the controller was given the true one. Of an elastic joint it is that of
            the side on which the encoder is.
        v_measured: velocity that they gave it (N, nv) [rad/s, m/s], or None.
        tau_measured: reading of `tau` of the same row by a torque sensor (N, nv) [N·m, N]; None
            without one, see `simulation.TorqueSensor`.
        arm: the true arm; where events changed it, that of the start.
        metadata: plain data that tells how the run was made (controller, gains, dt, versions).
        events: what the plant became in mid-run, in the order of time.
        wrenches: forces and torques at frames of the arm that acted.
    """

    t: Array
    q: Array
    v: Array
    q_d: Array
    v_d: Array
    e: Array
    e_dot: Array
    tau: Array
    signals: dict[str, Array]
    arm: Arm
    metadata: dict[str, Any] = field(default_factory=dict)
    events: tuple[PlantChange, ...] = ()
    wrenches: tuple[Wrench, ...] = ()
    q_measured: Array | None = None
    v_measured: Array | None = None
    tau_measured: Array | None = None

    def __len__(self) -> int:
        """Return the number of recorded ticks."""
        return len(self.t)

    @cached_property
    def error_norm(self) -> Array:
        """Euclidean norm of the tracking error (N,) [rad]."""
        norm: Array = np.linalg.norm(self.e, axis=1)
        return norm

    @cached_property
    def q_motor(self) -> Array:
        """Configuration of the motors (N, nq); `q` is that of the links, the same where rigid."""
        deflection = self.signals.get("deflection")
        if deflection is None:
            return self.q
        if self.arm.is_euclidean:
            return self.q + deflection
        return np.array(
            [self.arm.integrate(q, turn) for q, turn in zip(self.q, deflection, strict=True)]
        )

    @property
    def v_motor(self) -> Array:
        """Velocity of the motors (N, nv), referred to the joints; `v` where they are rigid."""
        return self.signals.get("motor_speed", self.v)

    @property
    def e_motor(self) -> Array:
        """Error of the motors from the reference (N, nv): that of the links and the deflection."""
        return self.e + self.signals["deflection"] if "deflection" in self.signals else self.e

    @property
    def divergence(self) -> dict[str, Any] | None:
        """Where the run was given up, "time" [s] and "joint"; None where it went to its end."""
        return self.metadata.get("divergence")

    def __repr__(self) -> str:
        """Name the law and the arm, and tell the size: the arrays would fill pages."""
        law = self.metadata.get("controller", "unknown controller")
        span = f"{self.t[-1] - self.t[0]:g} s" if len(self) else "0 s"
        lost = "" if self.divergence is None else ", diverged"
        size = f"{len(self)} rows over {span}, {self.arm.nv} joints{lost}"
        return f"<Recording of {law} on {self.arm.name}: {size}>"

    _repr_html_ = page_of

    def save(self, path: str | os.PathLike[str], *, progress: Progress = False) -> None:
        """Write everything into one `.npz` file, without pickle, whole or not at all.

        Args:
            path: the file; missing folders are made.
            progress: True shows a bar on standard error; a callable is told the fraction done.
        """
        about = {
            "arm": self.arm.to_dict(),
            "metadata": self.metadata,
            "events": [event.to_dict() for event in self.events],
            "wrenches": [wrench.to_dict() for wrench in self.wrenches],
        }
        arrays = {name: getattr(self, name) for name in ARRAYS}
        read = {name: getattr(self, name) for name in READINGS}
        arrays |= {name: table for name, table in read.items() if table is not None}
        with reporting(progress, f"Saving {Path(path).name}") as report, replacing(path) as stream:
            recording_file.write(stream, arrays, self.signals, about, report)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Recording:
        """Read a recording that `save` wrote; the arm is rebuilt from what the file holds.

        A file that `run_realtime` was writing when the program died is read as far as it goes.

        Raises:
            RecordingError: the file is not a recording, or is damaged.
            FileNotFoundError: no such file.
        """
        with Path(path).open("rb") as stream:
            try:
                if is_journal(stream.peek(len(MAGIC))):
                    from fotsmc_pin.simulation.measured_run import unfinished_run

                    return unfinished_run(stream)
                found = recording_file.read(path, stream, ARRAYS, READINGS)
                header = found.pop("header")
                return cls(
                    arm=Arm.from_dict(header["arm"]),
                    metadata=header["metadata"],
                    events=tuple(map(PlantChange.from_dict, header.get("events", ()))),
                    wrenches=tuple(Wrench(**parts) for parts in header.get("wrenches", ())),
                    **found,
                )
            except RecordingError:
                raise
            except Exception as error:  # the parsers raise many kinds on damaged bytes
                raise RecordingError(f"{path}: not a recording of fotsmc_pin ({error})") from error


READINGS = ("q_measured", "v_measured", "tau_measured")
"""Arrays that a recording has only where sensors gave them."""
OTHERS = ("signals", "arm", "metadata", "events", "wrenches", *READINGS)
ARRAYS = tuple(f.name for f in fields(Recording) if f.name not in OTHERS)
