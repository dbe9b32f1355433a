"""Writing files atomically, into a temporary file beside the target, then renamed over it."""

from __future__ import annotations

import json
import math
import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a binary file that takes the place of `path` only once it is complete.

    Missing folders are made. When the block raises, the old target stays as it was.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            yield stream
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno is not None and error.filename is None:
            error.filename = str(target)  # A full disk names no file by itself.
        raise


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write `text` as UTF-8 over `path`, whole or not at all."""
    with replacing(path) as stream:
        stream.write(text.encode())


def write_json(path: str | os.PathLike[str], data: Mapping[str, Any]) -> None:
    """Write plain data as indented JSON; infinity is written as the string "inf"."""
    write_text(path, json.dumps(_finite(data), indent=2, ensure_ascii=False) + "\n")


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]], align: str) -> str:
    """Return a Markdown table.

    Args:
        head: title of each column.
        rows: cells of each row, as they are to be read: no text is taken for a number.
        align: "l" or "r" for each column.
    """
    rules = [{"l": "---", "r": "---:"}[side] for side in align]
    return "".join(
        f"| {' | '.join(cells)} |\n"
        for cells in (_one_line(head), rules, *(_one_line(row) for row in rows))
    )


def _one_line(cells: Sequence[str]) -> list[str]:
    return [" ".join(cell.replace("|", "\\|").split()) for cell in cells]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, float) and math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return value


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
