"""`fotsmc report`: a folder of results as one offline page."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.output import Force, plain_console, result_file


def report(
    folder: Annotated[
        Path, typer.Argument(help="A folder that a command wrote, or of saved runs.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="The page; by default report.html in FOLDER.")
    ] = None,
    title: Annotated[str | None, typer.Option(help="Heading of the page.")] = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page when done.")] = False,
    force: Force = False,
) -> None:
    """Write what was run, its metrics, figures, claims and animation as one HTML file."""
    from fotsmc_pin.view import write_report

    page = write_report(
        folder,
        result_file(out or folder / "report.html", force=force),
        title=title,
        progress=True,
    )
    plain_console().print(f"Open {page} in a browser.")
    if open_page:
        webbrowser.open(page.resolve().as_uri())
