"""Where a command's results go, and how it says so."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.errors import OutputExistsError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
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


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on the terminal's error stream while the block runs; call it with the fraction."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=1.0)
        yield lambda fraction: bar.update(task, completed=fraction)
