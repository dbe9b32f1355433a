"""The command line, `fotsmc`: a file per command, which imports what it needs when it runs."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from fotsmc_pin.cli.animate import animate
from fotsmc_pin.cli.arms import arms_command
from fotsmc_pin.cli.convert import convert
from fotsmc_pin.cli.excite import excite
from fotsmc_pin.cli.export import export_command
from fotsmc_pin.cli.identify import identify_command
from fotsmc_pin.cli.inspect import inspect_command
from fotsmc_pin.cli.margins import margins_command
from fotsmc_pin.cli.output import INTERRUPTED, UsageError, say_error, speak_plainly
from fotsmc_pin.cli.payload import payload_command
from fotsmc_pin.cli.perturb import perturb_command
from fotsmc_pin.cli.plain_help import PlainCommand, PlainGroup
from fotsmc_pin.cli.report import report
from fotsmc_pin.cli.reproduce import reproduce
from fotsmc_pin.cli.simulate import simulate
from fotsmc_pin.cli.stress import stress
from fotsmc_pin.cli.study import study_command
from fotsmc_pin.cli.tune import tune
from fotsmc_pin.errors import FotsmcError


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"fotsmc_pin {version('fotsmc_pin')}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Fractional-order terminal sliding mode control for any robot arm that has a URDF."""


app = typer.Typer(
    name="fotsmc", cls=PlainGroup, no_args_is_help=True, pretty_exceptions_enable=False
)
app.callback()(_root)
app.command("reproduce", cls=PlainCommand)(reproduce)
app.command("simulate", cls=PlainCommand)(simulate)
app.command("animate", cls=PlainCommand)(animate)
app.command("report", cls=PlainCommand)(report)
app.command("convert", cls=PlainCommand)(convert)
app.command("arms", cls=PlainCommand)(arms_command)
app.command("inspect", cls=PlainCommand)(inspect_command)
app.command("excite", cls=PlainCommand)(excite)
app.command("identify", cls=PlainCommand)(identify_command)
app.command("payload", cls=PlainCommand)(payload_command)
app.command("margins", cls=PlainCommand)(margins_command)
app.command("export", cls=PlainCommand)(export_command)
app.command("perturb", cls=PlainCommand)(perturb_command)
app.command("stress", cls=PlainCommand)(stress)
app.command("tune", cls=PlainCommand)(tune)
app.command("study", cls=PlainCommand)(study_command)


def main() -> None:
    """Run the command line; a mistake of the user ends in one line and exit code 2."""
    speak_plainly()
    try:
        sys.exit(app(prog_name="fotsmc", standalone_mode=False))
    except UsageError as error:
        say_error(f"{_mistake(error)} See: {_command(error)} --help")
        sys.exit(error.exit_code)
    except FotsmcError as error:
        say_error(str(error))
        sys.exit(2)
    except OSError as error:
        where = "" if error.filename is None else f"{error.filename}: "
        say_error(f"{where}{error.strerror or error}")
        sys.exit(2)
    except MemoryError as error:
        say_error(f"not enough memory: {error}")
        sys.exit(2)
    except (KeyboardInterrupt, typer.Abort):
        say_error("interrupted")
        sys.exit(INTERRUPTED)


def _mistake(error: typer.BadParameter) -> str:
    """Return what is wrong with a command line, in the words that this library has for it."""
    near = getattr(error, "possibilities", None)
    option = getattr(error, "option_name", None)
    if option is None:
        return error.format_message().replace("Value error, ", "")
    return f"No such option: {option}." + (f" Did you mean {near[0]}?" if near else "")


def _command(error: typer.BadParameter) -> str:
    context = getattr(error, "ctx", None)
    return "fotsmc" if context is None else str(context.command_path)
