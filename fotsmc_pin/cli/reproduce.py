"""`fotsmc reproduce`: the paper's two-link case, from two URDFs to figures, claims and a page."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.output import Force, plain_console, plain_table, result_folder


def reproduce(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/two_link"),
    force: Force = False,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page when done.")] = False,
) -> None:
    """Run the paper's two-link case and judge its claims."""
    from fotsmc_pin.paper.reproduce import reproduce as run_the_paper

    folder = result_folder(out, force=force)
    verdicts = run_the_paper(folder, progress=True)

    table = plain_table("The paper's claims")
    for column in ("where", "claim", "holds"):
        table.add_column(column)
    for verdict in verdicts:
        table.add_row(verdict.where, verdict.claim, verdict.word)
    console = plain_console()
    console.print(table)
    console.print(
        f"Read what was measured in {folder / 'claims.md'} and {folder / 'comparison.md'}."
    )
    page = folder / "two_link.html"
    console.print(f"Open {page} in a browser.")
    if open_page:
        webbrowser.open(page.resolve().as_uri())
