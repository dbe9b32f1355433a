"""The command line, `fotsmc`: a file per command, which imports what it needs when it runs."""

from __future__ import annotations

import sys

import typer

from fotsmc_pin.cli.animate import animate
from fotsmc_pin.cli.arms import arms_command
from fotsmc_pin.cli.inspect import inspect_command
from fotsmc_pin.cli.perturb import perturb_command
from fotsmc_pin.cli.report import report
from fotsmc_pin.cli.reproduce import reproduce
from fotsmc_pin.cli.simulate import simulate
from fotsmc_pin.cli.stress import stress
from fotsmc_pin.cli.study import study_command
from fotsmc_pin.cli.tune import tune
from fotsmc_pin.errors import FotsmcError

app = typer.Typer(
    name="fotsmc",
    help="Fractional-order terminal sliding mode control for any robot arm that has a URDF.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command("reproduce")(reproduce)
app.command("simulate")(simulate)
app.command("animate")(animate)
app.command("report")(report)
app.command("arms")(arms_command)
app.command("inspect")(inspect_command)
app.command("perturb")(perturb_command)
app.command("stress")(stress)
app.command("tune")(tune)
app.command("study")(study_command)


def main() -> None:
    """Run the command line; a mistake of the user ends in one line and exit code 2."""
    try:
        app()
    except FotsmcError as error:
        print(f"fotsmc: {error}", file=sys.stderr)  # noqa: T201
        sys.exit(2)
    except OSError as error:
        print(f"fotsmc: {error.filename}: {error.strerror}", file=sys.stderr)  # noqa: T201
        sys.exit(2)
