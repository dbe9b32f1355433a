"""The figures of a report, inlined: the folder's own, and those drawn from its runs."""

from __future__ import annotations

import base64
import html
import re
import struct
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.learning import recorded_estimates
from fotsmc_pin.view.figures import comparison_figure, overview_figure, tracking_figure
from fotsmc_pin.view.learning_figure import learning_figure
from fotsmc_pin.view.many_run_tables import many_run_figures
from fotsmc_pin.view.style import PIXELS_PER_INCH, save_figure

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from matplotlib.figure import Figure

    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.view.results import Results

ENLARGED = 1.3
"""Figures are drawn for print; on a screen they are this much larger."""
ESTIMATES = "estimates"
"""Name of the figure of what was learnt."""
LEARNT_AT_MOST = 6
PIXELS_PER_POINT = 96.0 / 72.0


def figures(results: Results) -> str:
    """Return the folder's figures as HTML; drawn from the runs where there are none.

    What was learnt over time is drawn wherever the folder has no `estimates` figure.
    """
    pictures = [
        (path.stem, path.read_bytes())
        for path in results.pictures
        if results.study is None or path.stem != "distribution"
    ]
    if not pictures:
        pictures = [(name, drawn_bytes(figure)) for name, figure in _own_figures(results.runs)]
    if not any(name == ESTIMATES for name, _ in pictures):
        pictures += [(name, drawn_bytes(figure)) for name, figure in _learnt(results.runs)]
    return gallery(pictures)


def distributions(results: Results) -> str:
    """Return how the metrics of many runs are spread, as figures in HTML."""
    drawn = many_run_figures(results.study, results.stress)
    return gallery([(name, drawn_bytes(figure)) for name, figure in drawn])


def gallery(pictures: Sequence[tuple[str, bytes]]) -> str:
    """Return pictures by name as HTML."""
    shown = "".join(_figure(name, picture) for name, picture in pictures)
    return f'<div class="figures">{shown}</div>' if shown else ""


def _figure(name: str, picture: bytes) -> str:
    """Return a figure as an image: what a drawing holds stays apart from the page's own names."""
    words = html.escape(name.replace("_", " "))
    kind = "png" if picture.startswith(b"\x89PNG") else "svg+xml"
    data = base64.b64encode(picture).decode("ascii")
    width = f' width="{round(ENLARGED * _width(picture))}"'
    return (
        f'<figure><div class="wide" role="group" aria-label="Figure: {words}" tabindex="0">'
        f'<img alt="{words}"{width} src="data:image/{kind};base64,{data}"></div>'
        f"<figcaption>{words}</figcaption></figure>"
    )


def _width(picture: bytes) -> float:
    """Return the width that a picture has in print, in pixels of a page."""
    if picture.startswith(b"\x89PNG"):
        (pixels,) = struct.unpack(">I", picture[16:20])
        return float(pixels) * 96.0 / PIXELS_PER_INCH
    found = re.search(rb'<svg[^>]*\swidth="([\d.]+)pt"', picture)
    return float(found[1]) * PIXELS_PER_POINT if found else 515.0 * PIXELS_PER_POINT


def _learnt(runs: Mapping[str, Recording]) -> Iterator[tuple[str, Figure]]:
    """Yield the figures of what was learnt in each run, until the report has enough of them."""
    learning = {name: rec for name, rec in runs.items() if recorded_estimates(rec) is not None}
    for name, rec in [*learning.items()][:LEARNT_AT_MOST]:
        prefix = f"{name} " if len(learning) > 1 else ""
        yield f"{prefix}{ESTIMATES}", learning_figure(rec)


def _own_figures(runs: Mapping[str, Recording]) -> Sequence[tuple[str, Figure]]:
    if len({rec.arm.nv for rec in runs.values()}) == 1 and len(runs) > 1:
        return [("comparison", comparison_figure(runs))]
    drawn: list[tuple[str, Any]] = []
    for name, rec in runs.items():
        prefix = f"{name} " if len(runs) > 1 else ""
        drawn += [
            (f"{prefix}overview", overview_figure(rec)),
            (f"{prefix}tracking", tracking_figure(rec)),
        ]
    return drawn


def drawn_bytes(figure: Figure) -> bytes:
    """Return a figure as SVG."""
    with tempfile.TemporaryDirectory() as folder:
        (path,) = save_figure(figure, Path(folder) / "figure.svg")
        return path.read_bytes()
