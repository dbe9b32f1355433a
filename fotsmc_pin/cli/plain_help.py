"""Commands whose help shows its text as it is: brackets hold units, and are no markup."""

from __future__ import annotations

from typing import Any

import typer
from rich.markup import escape
from typer.core import TyperCommand, TyperGroup

from fotsmc_pin.cli.output import INTERRUPTED, say_error
from fotsmc_pin.errors import ArgumentError


class PlainCommand(TyperCommand):
    """A command that keeps `[m]` in the help of its options."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        _escape(self)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; Ctrl-C ends it in one line, and errors speak of options as typed."""
        try:
            return super().invoke(ctx)
        except ArgumentError as error:
            options = {parameter.name: parameter.opts[0] for parameter in self.params}
            typed = options.get(error.argument, "")
            if not typed.startswith("--"):
                raise
            raise ArgumentError(typed, error.value, error.remedy) from error
        except KeyboardInterrupt:
            say_error("interrupted")
            raise typer.Exit(INTERRUPTED) from None


class PlainGroup(TyperGroup):
    """A group of commands that does."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        _escape(self)


def _escape(command: TyperCommand | TyperGroup) -> None:
    for parameter in command.params:
        text = getattr(parameter, "help", None)
        if text:
            parameter.help = escape(text)  # type: ignore[attr-defined]
