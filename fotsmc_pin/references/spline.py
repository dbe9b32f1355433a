"""`Spline`: a recorded or computed trajectory, from arrays or a CSV file; and its polynomials."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.arms.columns import TIME, Column, unit_flaw
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.path import JointPath, unwrapped
from fotsmc_pin.references.time_scaling import motion_limits

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


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
            ArgumentError: unusable samples, or a position or velocity limit exceeded.
        """
        x = unwrapped(arm, "q", q)
        times = np.array(t, dtype=np.float64)
        if times.shape != (len(x),) or not np.isfinite(times).all():
            raise ArgumentError("t", t, f"give {len(x)} finite times, one for each configuration")
        if len(x) < 4 or np.any(np.diff(times) <= 0.0):
            raise ArgumentError("t", t, "give at least 4 times, each after the one before")
        degree = 5 if len(x) >= 6 else 3
        breaks, pieces = spline_pieces(times - times[0], x, degree=degree, rest=rest)
        path = cls(arm=arm, breaks=breaks, coefficients=pieces)
        path.demand_limits("q", q, *motion_limits(arm, None, None))
        return path

    @classmethod
    def from_csv(cls, arm: Arm, path: str | PathLike[str], *, rest: bool = False) -> Spline:
        """Interpolate a CSV file: a column of times [s] and one position per joint [rad or m].

        A header with `t` and joint names may put the columns in any order, and is needed where the
        file has further columns; without a header they are the time and the joints in the arm's
        order. A continuous joint has one column, its angle. A joint's column is headed `NAME` or
        `q.NAME`, with or without its unit, as in `t [s],q.joint1 [rad]`, which is how
        `Excitation.to_csv` and logs are written. Lines that begin with # are comments.

        Args:
            arm: the arm.
            path: the file.
            rest: whether velocity and acceleration are zero at both ends.

        Raises:
            ArgumentError: columns or rows that are missing or not numeric, with the line; or
                samples that `from_samples` refuses.
            FileNotFoundError: no such file.
        """
        demand_arm(arm)
        with Path(path).open(newline="", encoding="utf-8") as file:
            rows = (line for line in file if not line.startswith("#"))
            lines = [line for line in csv.reader(rows) if any(cell.strip() for cell in line)]
        columns = list(range(arm.nv + 1))
        first_row = 1
        if lines and not _is_number(lines[0][0]):
            columns = _columns(arm, str(path), lines.pop(0))
            first_row = 2
        numbers = []
        for number, line in enumerate(lines, first_row):
            try:
                numbers.append([float(line[column]) for column in columns])
            except (ValueError, IndexError):
                raise ArgumentError(
                    "path", str(path), f"row {number} does not hold {arm.nv + 1} numbers"
                ) from None
        table = np.array(numbers).reshape(-1, arm.nv + 1)
        if not np.isfinite(table).all():
            raise ArgumentError("path", str(path), "every entry must be finite")
        configurations = [arm.from_joint_positions(row) for row in table[:, 1:]]
        return cls.from_samples(
            arm, table[:, 0], np.reshape(configurations, (-1, arm.nq)), rest=rest
        )


def spline_pieces(t: Array, x: Array, *, degree: int = 5, rest: bool = True) -> tuple[Array, Array]:
    """Return the spline through samples as the break points and coefficients of a `JointPath`.

    Args:
        t: times, (n,) [s], increasing, from 0.
        x: joint positions, (n, nv).
        degree: 3 or 5; the spline has `degree - 1` continuous derivatives.
        rest: whether velocity (and acceleration, at degree 5) is zero at both ends; otherwise the
            ends are free ("not-a-knot"), and the first and last few samples share a polynomial.

    Returns:
        breaks: (pieces + 1,) [s].
        coefficients: highest power first, (degree + 1, pieces, nv).
    """
    still = [(order, np.zeros(x.shape[1])) for order in range(1, (degree + 1) // 2)]
    # SciPy takes pairs of (order, value) for each end, which its type stubs do not know.
    ends: Any = (still, still) if rest else None
    spline = make_interp_spline(t, x, k=degree, bc_type=ends)
    weights: Array = spline.c
    # A B-spline repeats its end knots `degree` times: pieces of no length, which are cut off.
    inner = slice(degree, -degree)
    columns = [PPoly.from_spline((spline.t, column, degree)).c[:, inner] for column in weights.T]
    return spline.t[inner], np.stack(columns, axis=-1)


def _columns(arm: Arm, path: str, header: list[str]) -> list[int]:
    """Return which column of a file holds the time, and which the position of each joint."""
    places: dict[str, int] = {}
    for place, head in enumerate(header):
        column = Column.of(head)
        if column.kind in ("", "q", TIME):
            places.setdefault(column.joint or TIME, place)
    missing = [name for name in (TIME, *arm.joint_names) if name not in places]
    if missing:
        raise ArgumentError("path", path, f"the header has no column {missing[0]!r}")
    columns = [places[name] for name in (TIME, *arm.joint_names)]
    for place, unit in zip(columns, ("s", *arm.position_units), strict=True):
        stated = Column.of(header[place]).unit
        flaw = unit_flaw(header[place].strip(), stated, unit) if stated else None
        if flaw is not None:
            raise ArgumentError("path", path, flaw)
    return columns


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
