"""`read_log`: a robot's log from a file, whatever wrote it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.errors import LogError
from fotsmc_pin.identification.clock import steady
from fotsmc_pin.identification.csv_log import read_csv
from fotsmc_pin.identification.diagnosis import LogWarning
from fotsmc_pin.identification.log import TORQUES, Log, recorded_torque
from fotsmc_pin.identification.log_table import LogTable
from fotsmc_pin.identification.ros_log import read_ros
from fotsmc_pin.references.path import unwrapped
from fotsmc_pin.simulation import Recording
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm

KINDS = "a recording (.npz), a CSV file (.csv), a ROS 2 bag (folder, .db3) or an MCAP file (.mcap)"


def read_log(
    path: str | os.PathLike[str],
    arm: Arm,
    *,
    torque: str | None = None,
    compensates: Sequence[str] | None = None,
    topic: str | None = None,
    start: float | None = None,
    stop: float | None = None,
) -> Log:
    """Read a robot's log for identification.

    Joints are found by their names in the URDF, in any order; further joints, such as fingers, are
    left out. Four kinds of files are read, by their suffix:

    - `.npz`: a recording of this library: `tau_measured` where there is one, the torque that was
      applied ("commanded") otherwise; of a run on a robot what was sent, with what its drives add.
    - `.csv`: columns `t [s]`, `q.JOINT [rad]`, `v.JOINT [rad/s]` (may be left out) and
      `tau_measured.JOINT [N·m]`, or `tau_commanded`, or `tau`, which does not say what it is; `m`,
      `m/s` and `N` for joints that slide. Each must state its unit. A line
      `# compensates: gravity` (or `nothing`) above the header says what the robot adds itself.
    - a ROS 2 bag (a folder, or `.db3`) or `.mcap`: messages `sensor_msgs/JointState`, by the extra
      "logs".

    Stamps that stand twice count once, short gaps are bridged, longer ones stay, and rows that are
    not evenly spaced between them are resampled (`clock.steady`); `Log.notes` says all that was
    found and done.

    Args:
        path: the file or folder.
        arm: the arm, for names, units and limits.
        torque: "measured" (by sensors or motor currents) or "commanded" (what a controller asked
            for); needed where the file does not say.
        compensates: what the robot adds itself to the torque that stands in the log: `()` for
            nothing, `("gravity",)`, `("gravity", "friction")`; needed where the file does not say.
        topic: of a ROS bag with joint states on several topics.
        start: read from this time on, since the first row [s].
        stop: read up to this time [s].

    Returns:
        The log, evenly spaced between gaps; its time begins at 0 with the first row that is kept.

    Raises:
        LogError: what the file lacks or contradicts: columns by name, units, the meaning of the
            torque, kinds of torque mixed, stamps that run backwards. Whether the numbers can be
            what their heads say, `identify` judges.
        MissingDependencyError: a ROS bag, and rosbags is not installed.
        RecordingError: a damaged `.npz` file.
        FileNotFoundError: no such file.

    Warns:
        LogWarning: stamps were repeated or out of order, or rows are missing.
    """
    demand_arm(arm)
    if torque is not None:
        checks.choice("torque", torque, TORQUES)
    table = _table(Path(path), arm, topic)
    return assembled(table, arm, torque, compensates, (start, stop))


def _table(path: Path, arm: Arm, topic: str | None) -> LogTable:
    if not path.exists():
        raise FileNotFoundError(2, "no such log", str(path))
    suffix = path.suffix.lower()
    if path.is_dir() or suffix in (".mcap", ".db3"):
        return read_ros(path, arm, topic)
    if suffix == ".npz":
        return of_recording(str(path), Recording.load(path))
    if suffix in (".csv", ".txt"):
        return read_csv(path, arm)
    raise LogError("file", f"{path}: give {KINDS}")


def of_recording(source: str, rec: Recording) -> LogTable:
    """Return the table of a recording: what sensors read where there were some."""

    def by_joint(rows: np.ndarray) -> dict[str, np.ndarray]:
        return dict(zip(rec.arm.joint_names, np.ascontiguousarray(rows).T, strict=True))

    q = rec.q_motor if rec.q_measured is None else rec.q_measured
    v = rec.v_motor if rec.v_measured is None else rec.v_measured
    kind, tau, compensates = recorded_torque(rec)
    return LogTable(
        source=source,
        t=np.asarray(rec.t),
        q=by_joint(unwrapped(rec.arm, "q", q)),
        v=by_joint(v),
        tau={kind: by_joint(tau)},
        compensates=compensates,
    )


def assembled(
    table: LogTable,
    arm: Arm,
    torque: str | None,
    compensates: Sequence[str] | None,
    window: tuple[float | None, float | None],
) -> Log:
    """Return the log of a table: the arm's joints, one kind of torque, an even clock.

    Raises:
        LogError: as `read_log` does.
    """
    x, v = table.positions(arm), table.velocities(arm)
    kind, tau = table.torques(arm, torque)
    kept = table.kept(compensates)
    parts = [x, tau] if v is None else [x, tau, v]
    t, rows = table.t - table.t[0] if len(table.t) else table.t, np.hstack(parts)
    inside = np.ones(len(t), dtype=bool)
    for bound, side in zip(window, (1.0, -1.0), strict=True):
        if bound is not None:
            inside &= side * t >= side * float(bound)
    clocked = steady(table.source, t[inside], rows[inside])
    n = arm.nv
    x, tau = clocked.columns[:, :n], clocked.columns[:, n : 2 * n]
    if v is not None:
        v = clocked.columns[:, 2 * n :]
    for what in clocked.alarming:
        warn_user(f"{table.source}: {what}", LogWarning)
    return Log(
        t=clocked.t - clocked.t[0],
        q=np.array([arm.from_joint_positions(row) for row in x]),
        v=v,
        tau=tau,
        joint_names=arm.joint_names,
        compensates=kept,
        source=table.source,
        torque=kind,
        notes=(*table.notes, *clocked.notes),
    )
