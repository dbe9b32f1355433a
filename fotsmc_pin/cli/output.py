"""Where a command's results go, and how it says so."""

from __future__ import annotations

import codecs
import re
import sys
import warnings
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.errors import OutputExistsError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rich.console import Console
    from rich.table import Table

UsageError: type[typer.BadParameter] = typer.BadParameter.__bases__[0]
"""What Typer raises of a command line that cannot be understood."""

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""

ASCII = {
    "·": "*",
    "²": "^2",
    "³": "^3",
    "⁻": "^-",
    "¹": "1",
    "×": "x",
    "–": "-",
    "—": "-",
    "…": "...",
    "≤": "<=",
    "≥": ">=",
    "∞": "inf",
    "τ": "tau",
    "°": "deg",
    "ė": "de",
    "’": "'",
}
"""What stands for a character on a terminal that does not have it."""

Force = Annotated[bool, typer.Option("--force", help="Overwrite an earlier result.")]


def result_folder(path: Path, *, force: bool) -> Path:
    """Return the folder for a result; refuse one that holds anything, unless forced.

    It is not made yet: a run that comes to nothing leaves no empty folder.

    Raises:
        OutputExistsError: the folder holds files and `force` is not set.
    """
    if path.exists() and not path.is_dir():
        raise OutputExistsError(f"--out {path}: is a file; name a folder")
    if not force and path.exists() and any(path.iterdir()):
        raise OutputExistsError(f"--out {path}: holds a result; name another folder or add --force")
    return path


def file_name(name: str) -> str:
    """Return a robot's or a person's name as one that a file can have, inside its folder."""
    return re.sub(r"[^\w.+-]+", "_", name).strip("._") or "arm"


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


def speak_plainly() -> None:
    """Let no character stop a command: what a terminal lacks is spelt in those that it has.

    Warnings become one line each on the error stream, without the source that they arose in.
    """

    def spelt(error: UnicodeError) -> tuple[str, int]:
        if not isinstance(error, UnicodeEncodeError):
            raise error
        lost = error.object[error.start : error.end]
        return "".join(ASCII.get(character, "?") for character in lost), error.end

    codecs.register_error("fotsmc_spelt", spelt)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="fotsmc_spelt")
    shown: set[str] = set()

    def show(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
        text = " ".join(str(message).split())
        if issubclass(category, UserWarning) and text not in shown:
            shown.add(text)
            print(f"fotsmc: warning: {text}", file=sys.stderr)  # noqa: T201

    warnings.showwarning = show


def say(text: str) -> None:
    """Print a line that the terminal may wrap and nothing else changes: paths stay whole."""
    plain_console().print(text, soft_wrap=True, highlight=False)


def say_error(text: str) -> None:
    """Print one line on the error stream."""
    print(f"fotsmc: {' '.join(text.split())}", file=sys.stderr)  # noqa: T201


def plain_table(title: str) -> Table:
    """Return an empty table that spends its width on what it says."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    return Table(
        title=title,
        title_justify="left",
        box=SIMPLE_HEAD,
        collapse_padding=True,
        pad_edge=False,
        min_width=min(len(title), plain_console().width),  # A title is no wider than its table.
    )


def show_table(title: str, rows: Sequence[tuple[str, str]]) -> None:
    """Print rows of a name and a value under a title; a narrow terminal wraps, and cuts nothing."""
    table = plain_table(title)
    table.show_header = False
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for row in rows:
        table.add_row(*row)
    plain_console().print(table)
