"""`Log`: what a robot measured while it moved, as identification takes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from os import PathLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array

COMPENSATED = ("gravity", "coriolis", "friction")
"""What a robot may add itself to the torque that it is commanded, and then is not in the log."""
TORQUES = ("measured", "commanded")
"""Where the torque of a log comes from."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Log:
    """A motion and the torque that made it, `T` samples.

    Attributes:
        t: time (T,) [s], rising.
        q: measured configuration (T, nq) [rad, m; cos and sin for a continuous joint].
        v: measured velocity (T, nv) [rad/s, m/s]; None where there is none.
        tau: torque at the joints, measured or commanded (T, nv) [N·m, N].
        joint_names: names of the joints, in the order of the columns of `v` and `tau`.
        compensates: what the robot adds itself and `tau` leaves out: any of "gravity", "coriolis",
            "friction".
        source: what to call the log in messages, such as the name of its file.
        torque: "measured" by sensors or currents, or "commanded" by a controller.
        notes: what reading it found and did, in plain words: stamps, gaps, resampling.

    Raises:
        ArgumentError: arrays of different lengths, numbers that are not finite, times that do not
            rise, or a word in `compensates` that means nothing.
    """

    t: Array
    q: Array
    v: Array | None
    tau: Array
    joint_names: tuple[str, ...]
    compensates: tuple[str, ...] = ()
    source: str = ""
    torque: str = "measured"
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check shapes and words."""
        object.__setattr__(self, "joint_names", tuple(self.joint_names))
        object.__setattr__(self, "compensates", tuple(self.compensates))
        object.__setattr__(self, "notes", tuple(self.notes))
        checks.choice("torque", self.torque, TORQUES)
        for word in self.compensates:
            checks.choice("compensates", word, COMPENSATED)
        for name in ("t", "q", "v", "tau"):
            value = getattr(self, name)
            if value is None and name == "v":
                continue
            array = np.asarray(value, dtype=np.float64)
            object.__setattr__(self, name, array)
            rows = np.shape(self.t)[:1]
            if array.ndim != (1 if name == "t" else 2) or array.shape[:1] != rows:
                raise ArgumentError(
                    name, array.shape, "give one row for each time, and t with one dimension"
                )
            if not np.all(np.isfinite(array)):
                row = int(np.argwhere(~np.isfinite(array))[0][0])
                raise ArgumentError(name, array[row], f"row {row} is not finite; leave it out")
        n = len(self.joint_names)
        for name in ("v", "tau"):
            array = getattr(self, name)
            if array is not None and array.shape[1] != n:
                raise ArgumentError(name, array.shape, f"give a column for each of {n} joints")
        if len(self.t) < 2 or np.any(np.diff(self.t) <= 0.0):
            raise ArgumentError("t", self.t, "give at least two times, each later than the last")

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.t)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return float(self.t[-1] - self.t[0])

    @property
    def label(self) -> str:
        """What to call the log."""
        return self.source or f"a log of {self.duration:.3g} s"

    def __repr__(self) -> str:
        """Name the source and the size; the arrays would fill pages."""
        size = f"{len(self)} rows over {self.duration:.4g} s, {len(self.joint_names)} joints"
        return f"<Log {self.source!r}: {size}>"

    def to_csv(self, path: str | PathLike[str], arm: Arm) -> None:
        """Write the log as a CSV file that `read_log` reads, with its meaning of torque.

        Args:
            path: the file; it is replaced.
            arm: whose joints these are, in the order of the log, for units and angles.
        """
        from fotsmc_pin.identification.csv_log import write_csv

        write_csv(path, self, arm)

    @classmethod
    def from_recording(cls, rec: Recording, *, source: str = "") -> Log:
        """Return the log of a run: what its sensors read, where the recording holds that.

        Args:
            rec: the recording. Where it has `q_measured`, `v_measured` or `tau_measured` these are
                taken; else the true motion of the motors, and the torque that was applied. Of a run
                on a robot whose drives add something that is the torque that was commanded,
                without what they add, as its metadata say: what they believe is not known.
            source: what to call it.
        """
        kind, tau, compensates = recorded_torque(rec)

        def measured(name: str, otherwise: Array) -> Array:
            found: Array | None = getattr(rec, f"{name}_measured", None)
            return otherwise if found is None else found

        return cls(
            t=rec.t,
            q=measured("q", rec.q_motor),
            v=measured("v", rec.v_motor),
            tau=tau,
            joint_names=rec.arm.joint_names,
            compensates=compensates,
            torque=kind,
            source=source or f"run of {rec.metadata.get('controller', 'a controller')}",
        )


def recorded_torque(rec: Recording) -> tuple[str, Array, tuple[str, ...]]:
    """Return which torque a recording holds, its rows (T, nv), and what the robot adds to it.

    Sensors feel weight and Coriolis torque whoever holds them, but not the friction that drives
    make up for.
    """
    adds = tuple(rec.metadata.get("compensates", ()))
    felt: Array | None = getattr(rec, "tau_measured", None)
    hidden = tuple(word for word in adds if word == "friction")
    if felt is not None:
        return "measured", felt, hidden
    sent = rec.signals.get("sent") if adds else None
    return ("commanded", rec.tau, hidden) if sent is None else ("commanded", sent, adds)
