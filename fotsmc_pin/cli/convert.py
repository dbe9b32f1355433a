"""`fotsmc convert`: a saved run as CSV, Parquet or MCAP."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.output import Force, result_file, say


def convert(
    run: Annotated[Path, typer.Argument(help="A run that was saved, such as run.npz.")],
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="The file to write: .csv, .parquet or .mcap."),
    ],
    force: Force = False,
) -> None:
    """Write a saved run for other programs: a CSV or Parquet table, or MCAP for PlotJuggler."""
    from fotsmc_pin.view import export_data

    written = export_data(run, result_file(out, force=force))
    say(f"Written to {written}.")
