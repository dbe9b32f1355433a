"""Progress of a long call: one meaning of the argument `progress`, and one bar."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

Progress: TypeAlias = bool | Callable[[float], None]
"""False says nothing, True shows a bar on standard error, a callable is told the fraction done."""


@contextmanager
def reporting(progress: Progress, title: str) -> Iterator[Callable[[float], None]]:
    """Give the block a function that takes the fraction done, from 0 to 1.

    Args:
        progress: False drops the fraction. True shows a bar with the time left on standard error,
            where that is a terminal or a notebook, and removes it at the end; standard output is
            left alone. A callable is handed on.
        title: what the bar says.
    """
    if callable(progress):
        yield progress
    elif progress:
        from rich.console import Console
        from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        name = TextColumn("{task.description}", markup=False)
        columns = (name, BarColumn(), TimeRemainingColumn())
        screen = Console(stderr=True)
        with Bar(
            *columns,
            console=screen,
            disable=not (screen.is_terminal or screen.is_jupyter),
            transient=True,
            redirect_stdout=False,
        ) as bar:
            task = bar.add_task(title, total=1.0)
            yield lambda fraction: bar.update(task, completed=fraction)
    else:
        yield lambda fraction: None
