"""The file of a recording: a plain `.npz` archive, written a stretch of rows at a time."""

from __future__ import annotations

import json
from typing import IO, TYPE_CHECKING, Any
from zipfile import ZIP_STORED, ZipFile, ZipInfo

import numpy as np

from fotsmc_pin.errors import RecordingError

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping

    from fotsmc_pin.types import Array

FORMAT = 4
OLDER_NAMES: dict[int, dict[str, str]] = {2: {"e_dot": "ed"}, 3: {}, FORMAT: {}}
"""Formats that can be read, each with the arrays that had another name in it."""
SIGNAL_PREFIX = "signal."
DIFFERENCES = {"e": ("q", "q_d"), "e_dot": ("v", "v_d")}
"""Arrays that are left out where they are, bit for bit, the difference of two others."""
STRETCH = 1 << 22
"""Bytes written at once, between two words of progress."""
ZIP_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Date of every member: the same recording gives the same bytes."""


def write(
    stream: IO[bytes],
    arrays: Mapping[str, Array],
    signals: Mapping[str, Array],
    about: Mapping[str, Any],
    report: Callable[[float], None],
) -> None:
    """Write a recording.

    The arrays are stored as they are: of the bits of a simulated motion, deflating saves a tenth
    and takes tens of times as long as writing them. A checksum of each array is stored with it.

    Args:
        stream: where to.
        arrays: fields of the recording by name.
        signals: the controller's signals by name.
        about: plain data that goes into the header.
        report: is told the fraction written.

    Raises:
        TypeError: `about` holds what JSON cannot.
    """
    derived = [
        name
        for name, (minuend, subtrahend) in DIFFERENCES.items()
        if is_difference(arrays[name], arrays[minuend], arrays[subtrahend])
    ]
    header = {"format": FORMAT, **about, "signals": [*signals], "derived": derived}
    members = {"header": np.array(json.dumps(header))}
    members |= {name: table for name, table in arrays.items() if name not in derived}
    members |= {SIGNAL_PREFIX + name: table for name, table in signals.items()}
    whole = sum(table.nbytes for table in members.values())
    written = 0
    with ZipFile(stream, "w", ZIP_STORED) as archive:
        for name, table in members.items():
            member = ZipInfo(f"{name}.npy", ZIP_EPOCH)
            with archive.open(member, "w", force_zip64=True) as file:
                shape = np.lib.format.header_data_from_array_1_0(table) | {"fortran_order": False}
                np.lib.format.write_array_header_1_0(file, shape)
                rows = max(1, STRETCH // max(table.nbytes // max(len(_rows(table)), 1), 1))
                for start in range(0, len(_rows(table)), rows):
                    part = np.ascontiguousarray(_rows(table)[start : start + rows])
                    file.write(memoryview(part).cast("B"))
                    written += part.nbytes
                    report(written / whole)


def read(
    path: str | os.PathLike[str],
    stream: IO[bytes],
    names: tuple[str, ...],
    optional: tuple[str, ...] = (),
) -> dict[str, Any]:
    """Return what `write` wrote: the arrays `names`, "signals" and the "header".

    Of the arrays `optional` those are returned that the file holds.

    Raises:
        RecordingError: the format is not one of those that this version reads.
        Exception: the parsers raise many kinds on damaged bytes.
    """
    with np.load(stream, allow_pickle=False) as file:
        header = json.loads(str(file["header"]))
        older = OLDER_NAMES.get(header["format"])
        if older is None:
            *first, last = map(str, OLDER_NAMES)
            readable = f"{', '.join(first)} and {last}"
            raise RecordingError(
                f"{path}: recording format {header['format']}, this version reads {readable}"
            )
        derived = header.get("derived", [])
        arrays = {name: file[older.get(name, name)] for name in names if name not in derived}
        arrays |= {name: file[name] for name in optional if name in file}
        signals = {name: file[SIGNAL_PREFIX + name] for name in header["signals"]}
    for name in derived:
        minuend, subtrahend = DIFFERENCES[name]
        arrays[name] = arrays[minuend] - arrays[subtrahend]
    return {**arrays, "signals": signals, "header": header}


def is_difference(table: Array, minuend: Array, subtrahend: Array) -> bool:
    """Return whether a table is `minuend - subtrahend` to the last bit, signs of zero included."""
    if not table.shape == minuend.shape == subtrahend.shape or table.dtype != np.float64:
        return False
    rows = max(1, STRETCH // max(8 * table[:1].size, 1))
    return all(
        np.array_equal(
            np.ascontiguousarray(table[k : k + rows]).view(np.int64),
            (minuend[k : k + rows] - subtrahend[k : k + rows]).view(np.int64),
        )
        for k in range(0, len(table), rows)
    )


def _rows(table: np.ndarray) -> np.ndarray:
    return table if table.ndim else table[None]
