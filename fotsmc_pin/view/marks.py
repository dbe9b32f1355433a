"""What happens in the middle of a run, in words and as marks in figures: events and wrenches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.view.palette import GREY, PUSH_COLOR

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from fotsmc_pin.simulation import Recording

FONT_SIZE = 5.5
CHARACTER, LINE = 0.55 * FONT_SIZE, 1.25 * FONT_SIZE
"""Width and height that a letter takes in a figure, about [pt]."""


@dataclass(frozen=True, kw_only=True)
class Mark:
    """Something that happens at a time, or from then until `end`.

    Attributes:
        time: when [s].
        end: when it is over [s]; None for an event, which changes the arm for good.
        words: what it is.
    """

    time: float
    end: float | None
    words: str

    @property
    def told(self) -> str:
        """When and what, as a line of a legend."""
        if self.end is None:
            return f"{self.time:.4g} s: {self.words}"
        return f"{self.time:.4g} s to {self.end:.4g} s: {self.words}"


def marks_of(recordings: Iterable[Recording]) -> list[Mark]:
    """Return what happens in runs, each thing once, in the order of time."""
    found = [
        mark
        for rec in recordings
        for mark in (
            *(Mark(time=event.time, end=None, words=event.words) for event in rec.events),
            *(Mark(time=w.start, end=w.end, words=w.words) for w in rec.wrenches),
        )
    ]
    return sorted(dict.fromkeys(found), key=lambda mark: mark.time)


def mark_axes(axes: NDArray[np.object_], recordings: Iterable[Recording]) -> None:
    """Draw a thin line at each event and a shade while a wrench acts; tell them above the figure.

    Args:
        axes: panels over time (rows, columns), drawn and titled.
        recordings: the runs that are drawn.
    """
    panels: list[Axes] = [*axes.flat]
    first = panels[0]
    begin, end = first.get_xlim()
    marks = [mark for mark in marks_of(recordings) if begin <= mark.time <= end]
    for mark in marks:
        for panel in panels:
            if mark.end is None:
                panel.axvline(mark.time, color=GREY, linewidth=0.6, zorder=1.5)
            else:
                panel.axvspan(
                    mark.time, min(mark.end, end), color=PUSH_COLOR, alpha=0.15, linewidth=0
                )
    figure = first.get_figure(root=True)
    width = 72.0 * 0.8 * (figure.get_figwidth() if figure else 1.0) / axes.shape[1]
    above = 1.5 * LINE if any(first.get_title(loc) for loc in ("left", "right")) else 0.0
    ends: list[float] = []  # of the words in each line, from the lowest on
    for mark in marks:
        length = CHARACTER * (len(mark.words) + 1)
        left = max(min((mark.time - begin) / (end - begin) * width, width - length), 0.0)
        line = next((k for k, taken in enumerate(ends) if taken <= left), len(ends))
        ends[line : line + 1] = [left + length]
        first.annotate(
            mark.words.replace("$", r"\$"),
            (left / width, 1.0),
            xycoords="axes fraction",
            xytext=(0.0, 0.4 * LINE + above + line * LINE),
            textcoords="offset points",
            fontsize=FONT_SIZE,
            color=GREY if mark.end is None else PUSH_COLOR,
        )
