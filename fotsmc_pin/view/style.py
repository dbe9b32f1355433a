"""The look of figures for papers: sizes, fonts, colours, and files written whole."""

from __future__ import annotations

import math
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.files import replacing
from fotsmc_pin.view.palette import COLORS

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

WIDTHS = {"column": 3.5, "page": 7.16}
"""Widths of a figure in one column and over the page of a two-column journal [in]."""

ROW_HEIGHT = 1.55
PIXELS_PER_INCH = 200
FORMATS = ("svg", "png", "pdf")

SETTINGS: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "lines.linewidth": 1.1,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#d9dde2",
    "grid.linewidth": 0.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "axes.unicode_minus": True,
    "svg.fonttype": "none",
    "svg.hashsalt": "fotsmc_pin",
    "pdf.fonttype": 42,
}


@contextmanager
def paper_style() -> Iterator[None]:
    """Make figures that are built or saved in this block look like those of this library."""
    import matplotlib as mpl
    from cycler import cycler

    settings: Any = {**SETTINGS, "axes.prop_cycle": cycler(color=COLORS)}
    with mpl.rc_context(settings):
        yield


def new_figure(
    rows: int = 1,
    columns: int = 1,
    *,
    width: Literal["column", "page"] = "column",
    row_height: float = ROW_HEIGHT,
    share_y: bool = False,
) -> tuple[Figure, NDArray[np.object_]]:
    """Return an empty figure and its axes (rows, columns), which share their time axis.

    The figure belongs to no window and no global list; it is gone when its last name is.

    Args:
        rows: panels on top of each other.
        columns: panels side by side.
        width: "column" or "page" of a two-column journal.
        row_height: height of a panel with its labels [in].
        share_y: whether panels of a row share their vertical axis.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with paper_style():
        figure = Figure(figsize=(WIDTHS[width], rows * row_height + 0.25), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(
            rows, columns, sharex=True, sharey="row" if share_y else False, squeeze=False
        )
    return figure, axes


def legend_above(figure: Figure, *panels: Axes) -> None:
    """Name the curves of the panels, each once, above the figure, on as many rows as it takes."""
    named: dict[str, Any] = {}
    for panel in panels:
        for line, label in zip(*panel.get_legend_handles_labels(), strict=True):
            named.setdefault(label, line)
    labels, lines = [*named], [*named.values()]
    for rows in range(1, len(labels) + 1):
        columns = math.ceil(len(labels) / rows)
        legend = figure.legend(lines, labels, loc="outside upper center", ncols=columns)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def spans_decades(values: Array) -> bool:
    """Return whether the finite ones of `values` want a logarithmic scale."""
    finite = values[abs(values) < math.inf]
    return bool(finite.size and finite.min() > 0.0 and finite.max() > 50.0 * finite.min())


def label_axis(axes: Axes, quantity: str, unit: str) -> None:
    """Write `quantity [unit]` beside the vertical axis."""
    axes.set_ylabel(f"{quantity} [{unit}]")


def label_time(axes: NDArray[np.object_]) -> None:
    """Write `time [s]` below the lowest panel of each column."""
    for column in axes[-1]:
        column.set_xlabel("time [s]")


def save_figure(
    figure: Figure, path: str | os.PathLike[str], formats: Sequence[str] = ("svg", "png")
) -> list[Path]:
    """Write a figure, whole or not at all, and return the files.

    The same figure gives the same bytes: neither a date nor random names are written.

    Args:
        figure: what to write.
        path: a file with the ending .svg, .png or .pdf, or a name without ending, to which each of
            `formats` is added.
        formats: endings for a path that has none of its own.

    Raises:
        ArgumentError: the ending is of none of the known formats.
        OSError: the file cannot be written.
    """
    target = Path(path)
    ending = target.suffix.removeprefix(".").lower()
    if ending in FORMATS:
        targets = {target: ending}
    elif ending and ending.isalpha():
        raise ArgumentError("path", str(path), "end the name with .svg, .png or .pdf")
    else:
        targets = {target.with_name(f"{target.name}.{kind}"): kind for kind in formats}
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": None}
    for file, kind in targets.items():
        with paper_style(), replacing(file) as stream:
            figure.savefig(stream, format=kind, dpi=PIXELS_PER_INCH, metadata=metadata[kind])
    return list(targets)
