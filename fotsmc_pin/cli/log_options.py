"""The options about logs, the same on every command that reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification import Log

PANEL = "The logs"
Logs = Annotated[
    list[Path],
    typer.Argument(help="Logs: recordings (.npz), CSV files, ROS 2 bags, MCAP files."),
]


@dataclass(frozen=True, kw_only=True)
class LogOptions:
    """How logs are read, as typed; `read` does it."""

    torque: Annotated[
        str | None,
        typer.Option(
            help="What the torque is, where the file does not say: measured or commanded.",
            rich_help_panel=PANEL,
        ),
    ] = None
    compensates: Annotated[
        list[str] | None,
        typer.Option(
            help="What the robot adds to that torque itself, where the file does not say: gravity, "
            "friction, or nothing; may be repeated.",
            rich_help_panel=PANEL,
        ),
    ] = None
    topic: Annotated[
        str | None, typer.Option(help="Topic of a ROS bag's joint states.", rich_help_panel=PANEL)
    ] = None

    def read(self, paths: Sequence[Path], arm: Arm) -> list[Log]:
        """Read the logs.

        Raises:
            FotsmcError: one cannot be read.
        """
        from fotsmc_pin.identification import read_log

        added = self.compensates
        words = None if added is None else tuple(word for word in added if word != "nothing")
        return [
            read_log(path, arm, torque=self.torque, compensates=words, topic=self.topic)
            for path in paths
        ]
