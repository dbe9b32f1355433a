"""`Journal`: the rows of a run in a file that can be read at any moment, also after a crash."""

from __future__ import annotations

import json
import mmap
import os
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from fotsmc_pin.types import Array

MAGIC = b"FOTSMCJ1"
"""First bytes of a journal."""
REASON = 248
"""Bytes that hold why the run was stopped."""
PAGE = 4096


class Journal:
    """A table that grows row by row, in memory or in a file.

    A file has its full size from the start: rows go into its pages without a call of the system,
    and are the system's from then on, so that they outlive the program however it ends. (They do
    not outlive a failure of power.) The last column of a row is its number from 1 on, written
    when the row is complete, by which a reader knows how far the rows go.

    Attributes:
        table: the rows (size, width + 1), the last column their number.
        filled: how many rows there are.
    """

    def __init__(self, path: Path | None, about: Mapping[str, Any], size: int, width: int) -> None:
        """Make room for `size` rows of `width` numbers; in memory where `path` is None.

        `about` is plain data that the file tells first.

        Raises:
            OSError: the file cannot be made, or there is no room for it.
        """
        self.filled, shape = 0, (size, width + 1)
        self._map: mmap.mmap | None = None
        if path is None:
            self.table: Array = np.zeros(shape)
            return
        header = json.dumps({**about, "size": size, "width": width}).encode()
        start = -(-(len(MAGIC) + REASON + 8 + len(header)) // PAGE) * PAGE
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w+b") as file:
            _reserve(file, start + 8 * size * (width + 1))
            file.write(MAGIC + bytes(REASON) + len(header).to_bytes(8, "little") + header)
            file.flush()
            self._map = mmap.mmap(file.fileno(), 0)
        self.table = np.frombuffer(self._map, np.float64, offset=start).reshape(shape)

    def end_row(self) -> None:
        """Count the row at `filled`, which was just written."""
        self.table[self.filled, -1] = self.filled + 1
        self.filled += 1

    def note_reason(self, reason: str) -> None:
        """Write why the run is stopped."""
        if self._map is not None:
            text = reason.encode()[:REASON]
            self._map[len(MAGIC) : len(MAGIC) + REASON] = text.ljust(REASON, b"\0")


def is_journal(start: bytes) -> bool:
    """Return whether a file that starts so is a journal."""
    return start.startswith(MAGIC)


def read_journal(stream: IO[bytes]) -> tuple[dict[str, Any], str, Array]:
    """Return what a journal tells first, why the run was stopped, and its rows (N, width).

    Raises:
        RecordingError: the file is damaged.
    """
    head = stream.read(len(MAGIC) + REASON + 8)
    length = int.from_bytes(head[-8:], "little")
    try:
        about = json.loads(stream.read(length))
        size, columns = about["size"], about["width"] + 1
    except (ValueError, KeyError, TypeError) as error:
        raise RecordingError(f"a journal whose head is damaged ({error})") from error
    stream.seek(-(-(len(head) + length) // PAGE) * PAGE)
    numbers = np.frombuffer(stream.read(8 * size * columns), np.float64)
    table = numbers[: len(numbers) // columns * columns].reshape(-1, columns)
    is_row = table[:, -1] == np.arange(1, len(table) + 1)
    rows = len(table) if is_row.all() else int(np.argmin(is_row))
    reason = head[len(MAGIC) : len(MAGIC) + REASON].rstrip(b"\0").decode(errors="replace")
    return about, reason, table[:rows, :-1]


def _reserve(file: IO[bytes], size: int) -> None:
    """Give a file its size, with room on the disk: a page without would end the program."""
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(file.fileno(), 0, size)
    else:
        file.truncate(size)
