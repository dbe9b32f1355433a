"""`fotsmc reproduce`: the paper's two-link case, from two URDFs to figures, claims and a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.output import Force, progress_bar, result_folder


def reproduce(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/two_link"),
    force: Force = False,
) -> None:
    """Run the paper's two-link case and judge its claims."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from fotsmc_pin.paper.reproduce import reproduce as run_the_paper

    folder = result_folder(out, force=force)
    with progress_bar("the two-link case") as report:
        verdicts = run_the_paper(folder, report)

    table = Table(title="The paper's claims, measured", title_justify="left")
    for column in ("where", "claim", "printed", "measured", "holds"):
        table.add_column(column)
    for verdict in verdicts:
        cells = (verdict.where, verdict.claim, verdict.printed, verdict.measured, verdict.word)
        table.add_row(*map(escape, cells))
    console = Console()
    console.print(table)
    console.print(f"Open {folder / 'two_link.html'} in a browser; read {folder / 'claims.md'}.")
