"""Progress of a long run: shown, told to a callable, or dropped."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextmanager
def reporting(
    progress: bool | Callable[[float], None], title: str
) -> Iterator[Callable[[float], None]]:
    """Give the block a function that takes the fraction done.

    Args:
        progress: True shows a bar with the time left on the terminal; a callable is handed on.
        title: what the bar says.
    """
    if callable(progress):
        yield progress
    elif progress:
        from rich.progress import Progress

        with Progress(transient=True) as bar:
            task = bar.add_task(title, total=1.0)
            yield lambda fraction: bar.update(task, completed=fraction)
    else:
        yield lambda fraction: None
