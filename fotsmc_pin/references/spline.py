"""`Spline`: a recorded or computed trajectory, from arrays or a CSV file."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.path import JointPath, unwrapped
from fotsmc_pin.references.splines import spline_pieces
from fotsmc_pin.references.timing import motion_limits

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm


@dataclass(frozen=True, kw_only=True, eq=False)
class Spline(JointPath):
    """The quintic spline through samples of a trajectory; cubic with fewer than six samples.

    Velocity and acceleration are the spline's own derivatives. Unless it is to rest at its ends,
    it starts and stops at whatever speed the samples have there.
    """

    @classmethod
    def from_samples(cls, arm: Arm, t: ArrayLike, q: ArrayLike, *, rest: bool = False) -> Spline:
        """Interpolate samples.

        Args:
            arm: the arm.
            t: times, (n,) [s], increasing, n ≥ 4; the first becomes 0.
            q: configurations, (n, nq).
            rest: whether velocity and acceleration are zero at both ends.

        Raises:
            ArgumentError: unusable samples, or a position or velocity limit that would break.
        """
        x = unwrapped(arm, "q", q)
        times = np.array(t, dtype=np.float64)
        if times.shape != (len(x),) or not np.isfinite(times).all():
            raise ArgumentError("t", t, f"give {len(x)} finite times, one for each configuration")
        if len(x) < 4 or np.any(np.diff(times) <= 0.0):
            raise ArgumentError("t", t, "give at least 4 times, each after the one before")
        breaks = times - times[0]
        degree = 5 if len(x) >= 6 else 3
        pieces = spline_pieces(breaks, x, degree=degree, rest=rest)
        path = cls(arm=arm, breaks=breaks, coefficients=pieces)
        path.demand_limits("q", q, *motion_limits(arm, None, None))
        return path

    @classmethod
    def from_csv(cls, arm: Arm, path: str | PathLike[str], *, rest: bool = False) -> Spline:
        """Interpolate a CSV file: a column of times [s] and one position per joint [rad or m].

        A header with `t` and joint names may put the columns in any order and is needed to leave
        columns out of account; without a header they are the time and the joints in the arm's
        order. A continuous joint has one column, its angle.

        Args:
            arm: the arm.
            path: the file.
            rest: whether velocity and acceleration are zero at both ends.

        Raises:
            ArgumentError: columns or rows that are missing or no numbers, with the line; or
                samples that `from_samples` refuses.
            FileNotFoundError: no such file.
        """
        demand_arm(arm)
        with Path(path).open(newline="", encoding="utf-8") as file:
            lines = [line for line in csv.reader(file) if any(cell.strip() for cell in line)]
        columns = list(range(arm.nv + 1))
        first_row = 1
        if lines and not _is_number(lines[0][0]):
            header = [cell.strip() for cell in lines.pop(0)]
            missing = [name for name in ("t", *arm.joint_names) if name not in header]
            if missing:
                raise ArgumentError("path", str(path), f"the header has no column {missing[0]!r}")
            columns = [header.index(name) for name in ("t", *arm.joint_names)]
            first_row = 2
        rows = []
        for number, line in enumerate(lines, first_row):
            try:
                rows.append([float(line[column]) for column in columns])
            except (ValueError, IndexError):
                raise ArgumentError(
                    "path", str(path), f"row {number} does not hold {arm.nv + 1} numbers"
                ) from None
        table = np.array(rows).reshape(-1, arm.nv + 1)
        if not np.isfinite(table).all():
            raise ArgumentError("path", str(path), "every entry must be finite")
        configurations = [arm.from_joint_positions(row) for row in table[:, 1:]]
        return cls.from_samples(
            arm, table[:, 0], np.reshape(configurations, (-1, arm.nq)), rest=rest
        )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
