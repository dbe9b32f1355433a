"""Logs as CSV files with a stated header."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms.columns import TIME, Column, heads, unit_flaw
from fotsmc_pin.errors import LogError
from fotsmc_pin.files import replacing
from fotsmc_pin.identification.log_table import LogTable
from fotsmc_pin.references.path import unwrapped

if TYPE_CHECKING:
    import os
    from pathlib import Path

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.log import Log
    from fotsmc_pin.types import Array

TORQUE_KINDS = {"tau": "", "tau_measured": "measured", "tau_commanded": "commanded"}
"""Heads of torque columns, and the kind of torque that each says."""
HEADER = "t [s],q.JOINT [rad],…,v.JOINT [rad/s],…,tau_measured.JOINT [N·m],…"


def read_csv(path: Path, arm: Arm) -> LogTable:
    """Return the columns of a CSV file whose header is like `HEADER`, in any order.

    A line `# compensates: gravity` or `# compensates: nothing` above the header says what the
    robot adds itself. Columns of other joints and kinds are left out.

    Raises:
        LogError: a header or unit that is missing or wrong, a row that is no row of numbers.
    """
    comments, lines = _split(path)
    if not lines:
        raise LogError("file", f"{path}: no header; the first line must be like {HEADER}")
    header = [head.strip() for head in next(csv.reader([lines[0]]))]
    columns = [Column.of(head) for head in header]
    if not any(column.kind == TIME for column in columns):
        raise LogError(
            "file", f"{path}: the header has no column 't [s]'; it must be like {HEADER}"
        )
    units = _units(arm)
    wanted: dict[tuple[str, str], int] = {}
    for place, (head, column) in enumerate(zip(header, columns, strict=True)):
        key = (column.kind, column.joint)
        unit = "s" if column.kind == TIME else units.get(key)
        if unit is None:
            continue
        if key in wanted:
            raise LogError("columns", f"{path}: column {head!r} stands twice")
        flaw = unit_flaw(head, column.unit, unit)
        if flaw is not None:
            raise LogError("degrees" if "π/180" in flaw else "units", f"{path}: {flaw}")
        wanted[key] = place
    table = _numbers(path, lines[1:], list(wanted.values()), 2 + len(comments))
    found = dict(zip(wanted, table.T, strict=True))

    def of(kind: str) -> dict[str, Array]:
        return {joint: values for (k, joint), values in found.items() if k == kind}

    tau = {meaning: of(kind) for kind, meaning in TORQUE_KINDS.items() if of(kind)}
    return LogTable(
        source=str(path),
        t=found[TIME, ""],
        q=of("q"),
        v=of("v"),
        tau=tau,
        compensates=_compensates(comments),
        others=tuple(dict.fromkeys(c.joint for c in columns if c.kind == "q")),
    )


def write_csv(path: str | os.PathLike[str], log: Log, arm: Arm) -> None:
    """Write a log as `read_csv` reads it, a continuous joint by its angle.

    Args:
        path: the file; it is replaced.
        log: the log.
        arm: whose joints these are, in the order of the log.
    """
    kinds = ["q", "v", f"tau_{log.torque}"] if log.v is not None else ["q", f"tau_{log.torque}"]
    parts = [unwrapped(arm, "q", log.q), log.v, log.tau]
    table = np.column_stack([log.t, *(part for part in parts if part is not None)])
    lines = [f"# compensates: {' '.join(log.compensates) or 'nothing'}"]
    lines.append(",".join(heads(arm, kinds)))
    lines += [",".join(format(number, ".12g") for number in row) for row in table.tolist()]
    with replacing(path) as stream:
        stream.write(("\n".join(lines) + "\n").encode())


def _split(path: Path) -> tuple[list[str], list[str]]:
    """Return the comments above the header, and all lines that hold something from it on."""
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise LogError("file", f"{path}: not a text file in UTF-8") from None
    comments = []
    for line in lines:
        if line.strip() and not line.startswith("#"):
            break
        comments.append(line)
    return comments, [line for line in lines[len(comments) :] if line.strip()]


def _units(arm: Arm) -> dict[tuple[str, str], str]:
    units: dict[tuple[str, str], str] = {}
    for name, unit, effort in zip(
        arm.joint_names, arm.position_units, arm.effort_units, strict=True
    ):
        units |= {("q", name): unit, ("v", name): f"{unit}/s"}
        units |= {(kind, name): effort for kind in TORQUE_KINDS}
    return units


def _numbers(path: Path, lines: list[str], places: list[int], first: int) -> Array:
    rows = []
    for number, line in enumerate(csv.reader(lines), first):
        try:
            rows.append([float(line[place]) for place in places])
        except (ValueError, IndexError):
            raise LogError(
                "file", f"{path}: line {number} does not hold a number in each column"
            ) from None
    table = np.array(rows).reshape(-1, len(places))
    if not np.isfinite(table).all():
        row = first + int(np.argwhere(~np.isfinite(table))[0][0])
        raise LogError("file", f"{path}: line {row} holds what is not finite; leave such rows out")
    return table


def _compensates(comments: list[str]) -> tuple[str, ...] | None:
    for comment in comments:
        name, colon, value = comment.lstrip("# ").partition(":")
        if colon and name.strip() == "compensates":
            words = tuple(value.replace(",", " ").split())
            return () if words in ((), ("nothing",), ("none",)) else words
    return None
