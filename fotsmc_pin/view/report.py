"""`write_report`: a folder of results as one offline page, from what was run to the moving arm."""

from __future__ import annotations

import base64
import html
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.files import write_text
from fotsmc_pin.view.export import export_html
from fotsmc_pin.view.figures import comparison_figure, overview_figure, tracking_figure
from fotsmc_pin.view.page import ASSETS
from fotsmc_pin.view.prose import prose
from fotsmc_pin.view.report_tables import facts, metrics_table
from fotsmc_pin.view.results import read_results
from fotsmc_pin.view.style import save_figure

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.view.results import Results

RUNS_AT_MOST = 6
"""More arms than this in one picture cannot be told apart."""


def write_report(
    folder: str | os.PathLike[str],
    path: str | os.PathLike[str] | None = None,
    *,
    title: str | None = None,
) -> Path:
    """Write one HTML file about a folder of results; it holds everything and fetches nothing.

    The folder is one that `fotsmc simulate` or `fotsmc reproduce` has written, or any that holds
    saved recordings (`*.npz`). The report shows the animation, a table of metrics, the verdicts on
    a paper's claims (`claims.md`), how laws compare (`comparison.md`), the figures (`*.svg`; drawn
    from the runs where there are none), and what was run: arm and what `perturb` did to it,
    controller, gains, versions.

    Args:
        folder: folder of results.
        path: file to write, whole or not at all; `report.html` in the folder by default.
        title: heading; by default the names of the arms.

    Returns:
        The path that was written.

    Raises:
        RecordingError: the folder holds no run, or damaged files.
        OSError: the folder cannot be read or the file cannot be written.
    """
    results = read_results(folder)
    target = results.folder / "report.html" if path is None else Path(path)
    arms = dict.fromkeys(rec.arm.name for rec in results.runs.values())
    sections = {
        "Animation": _animation(results.runs),
        "Metrics": metrics_table(results.summaries, results.titles),
        "Claims": prose(results.claims),
        "Comparison": prose(results.comparison),
        "Figures": _figures(results),
        "What was run": facts(results.runs),
    }
    sections = {name: content for name, content in sections.items() if content}
    parts = {
        "style": (ASSETS / "report.css").read_text("utf-8"),
        "title": html.escape(title or " and ".join(arms)),
        "subtitle": html.escape(_subtitle(results.runs)),
        "links": "".join(f'<a href="#{_anchor(name)}">{name}</a>' for name in sections),
        "sections": "\n".join(
            f'<section aria-labelledby="{_anchor(name)}">'
            f'<h2 id="{_anchor(name)}">{name}</h2>{content}</section>'
            for name, content in sections.items()
        ),
    }
    template = (ASSETS / "report.html").read_text("utf-8")
    write_text(target, re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template))
    return target


def _anchor(name: str) -> str:
    return name.lower().replace(" ", "-")


def _subtitle(runs: Mapping[str, Recording]) -> str:
    laws = dict.fromkeys(str(rec.metadata.get("controller", "")) for rec in runs.values())
    longest = max(float(rec.t[-1] - rec.t[0]) for rec in runs.values())
    count = "one run" if len(runs) == 1 else f"{len(runs)} runs"
    return ", ".join([*filter(None, laws), count, f"{longest:g} s"])


def _animation(runs: Mapping[str, Recording]) -> str:
    """Return the runs' page in a frame of its own, which keeps its styles and keys to itself."""
    shown = dict(list(runs.items())[:RUNS_AT_MOST])
    with tempfile.TemporaryDirectory() as folder:
        page = export_html(shown, Path(folder) / "page.html", play=False).read_text("utf-8")
    escaped = page.replace("&", "&amp;").replace('"', "&quot;")
    left_out = len(runs) - len(shown)
    note = f"<p>{left_out} more runs are not shown here.</p>" if left_out else ""
    return (
        f'<iframe title="Animation of {html.escape(", ".join(shown))}" sandbox="allow-scripts" '
        f'loading="lazy" srcdoc="{escaped}"></iframe>{note}'
    )


def _figures(results: Results) -> str:
    pictures = [(path.stem, path.read_bytes()) for path in results.pictures]
    if not pictures:
        pictures = [(name, _drawn(figure)) for name, figure in _own_figures(results.runs)]
    figures = "".join(_figure(name, svg) for name, svg in pictures)
    return f'<div class="figures">{figures}</div>'


def _figure(name: str, svg: bytes) -> str:
    """Return a figure as an image: what a drawing holds stays apart from the page's own names."""
    words = html.escape(name.replace("_", " "))
    data = base64.b64encode(svg).decode("ascii")
    return (
        f'<figure><img alt="{words}" src="data:image/svg+xml;base64,{data}">'
        f"<figcaption>{words}</figcaption></figure>"
    )


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


def _drawn(figure: Figure) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        (path,) = save_figure(figure, Path(folder) / "figure.svg")
        return path.read_bytes()
