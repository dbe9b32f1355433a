"""`fotsmc animate`: a saved run as one offline page."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.output import Force, plain_console, result_file


def animate(
    run: Annotated[Path, typer.Argument(help="A run that was saved, such as run.npz.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="The page to write.")] = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page when done.")] = False,
    force: Force = False,
) -> None:
    """Write a saved run as one HTML file that opens offline."""
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.view import export_html

    page = result_file(out or run.with_suffix(".html"), force=force)
    export_html(Recording.load(run), page, progress=True)
    plain_console().print(f"Open {page} in a browser.")
    if open_page:
        webbrowser.open(page.resolve().as_uri())
