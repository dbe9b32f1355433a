"""Where a command's results go, and how it says so."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.errors import OutputExistsError

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console

Force = Annotated[bool, typer.Option("--force", help="Overwrite an earlier result.")]


def result_folder(path: Path, *, force: bool) -> Path:
    """Make the folder for a result; refuse one that holds anything, unless forced.

    Raises:
        OutputExistsError: the folder holds files and `force` is not set.
    """
    if path.exists() and not path.is_dir():
        raise OutputExistsError(f"--out {path}: is a file; name a folder")
    if not force and path.exists() and any(path.iterdir()):
        raise OutputExistsError(f"--out {path}: holds a result; name another folder or add --force")
    path.mkdir(parents=True, exist_ok=True)
    return path


def result_file(path: Path, *, force: bool) -> Path:
    """Return the path of a result; refuse one that is there, unless forced.

    Raises:
        OutputExistsError: the file is there and `force` is not set.
    """
    if path.is_dir():
        raise OutputExistsError(f"{path}: is a folder; name a file")
    if path.exists() and not force:
        raise OutputExistsError(f"{path}: is there already; name another file or add --force")
    return path


def plain_console() -> Console:
    """Return a terminal that prints text as it is: brackets hold units and names, no markup."""
    from rich.console import Console

    return Console(markup=False)
