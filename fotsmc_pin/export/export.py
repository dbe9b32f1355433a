"""`export_c`: a controller as two files of C99."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fotsmc_pin.export.files import Files
from fotsmc_pin.files import write_text

if TYPE_CHECKING:
    import os

    from fotsmc_pin.control import Controller


def export_c(
    controller: Controller, folder: str | os.PathLike[str], *, single: bool = False
) -> tuple[Path, Path]:
    """Write a controller as C99.

    Args:
        controller: any control law, tuned; it stays as it is.
        folder: where the files go.
        single: whether numbers are `float` in place of `double`.

    Returns:
        The header and the program.
    """
    files = Files(controller, single=single)
    source, header = files.source(), files.header()
    paths = Path(folder) / f"{files.prefix}.h", Path(folder) / f"{files.prefix}.c"
    for path, text in zip(paths, (header, source), strict=True):
        write_text(path, text)
    return paths
