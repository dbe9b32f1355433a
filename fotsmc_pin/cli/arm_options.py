"""The options about an arm, the same on every command that takes one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.values import number
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

PANEL = "The arm"
ARM = "A URDF file, or a name that `fotsmc arms` lists."


def complete_arm(incomplete: str) -> list[str]:
    """Return the names of arms that begin like this, for the shell's completion."""
    from fotsmc_pin.arms.catalog import known_names

    return [name for name in known_names() if name.startswith(incomplete)]


ArmName = Annotated[str, typer.Argument(help=ARM, autocompletion=complete_arm)]
ArmNames = Annotated[
    list[str],
    typer.Argument(help="URDF files, or names of `fotsmc arms`.", autocompletion=complete_arm),
]


@dataclass(frozen=True, kw_only=True)
class ArmOptions:
    """How an arm is loaded, as typed; `load` does it."""

    lock: Annotated[
        list[str] | None,
        typer.Option(
            help="Joint to fix: name or pattern, or name=position [rad, m]; may be repeated.",
            rich_help_panel=PANEL,
            metavar="JOINT",
        ),
    ] = None
    keep: Annotated[
        list[str] | None,
        typer.Option(
            help="Joint to leave free, name or pattern; all others are fixed; may be repeated.",
            rich_help_panel=PANEL,
            metavar="JOINT",
        ),
    ] = None
    armature: Annotated[
        list[str] | None,
        typer.Option(
            help="Rotor inertia seen from the joint [kg·m², kg]: number, name=number, or the word "
            "rotors for an estimate where the file gives none; may be repeated.",
            rich_help_panel=PANEL,
            metavar="VALUE",
        ),
    ] = None
    tool_frame: Annotated[
        str | None, typer.Option(help="Link at the tool.", rich_help_panel=PANEL, metavar="LINK")
    ] = None
    gravity: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            help="Gravity in the frame of the base, three numbers [m/s²]; 0 0 9.81 hangs the arm "
            "from a ceiling.",
            rich_help_panel=PANEL,
            metavar="X Y Z",
        ),
    ] = None
    package_dir: Annotated[
        list[Path] | None,
        typer.Option(
            help="Where package:// begins; may be repeated.",
            rich_help_panel=PANEL,
            metavar="FOLDER",
        ),
    ] = None

    def load(self, source: str) -> Arm:
        """Load the arm.

        Raises:
            FotsmcError: an option or the file cannot be used.
        """
        from fotsmc_pin.arms import load_arm

        given: dict[str, Any] = {
            "lock": _locks(self.lock),
            "keep": self.keep or None,
            "armature": _armature(self.armature),
            "tool_frame": self.tool_frame,
            "gravity": self.gravity,
            "package_dirs": self.package_dir or None,
        }
        return load_arm(
            source, **{name: value for name, value in given.items() if value is not None}
        )


def _locks(given: list[str] | None) -> list[str] | dict[str, float] | None:
    if not given:
        return None
    if not any("=" in item for item in given):
        return given
    placed: dict[str, float] = {}
    for item in given:
        name, equals, value = item.rpartition("=")
        if not equals:
            raise ArgumentError("--lock", item, "give every locked joint its position, or none")
        placed[name] = _plain("--lock", item, value)
    return placed


def _armature(given: list[str] | None) -> Any:
    if not given:
        return None
    if given == ["rotors"]:
        return "rotors"
    if len(given) == 1 and "=" not in given[0]:
        return _plain("--armature", given[0], given[0])
    named: dict[str, float] = {}
    for item in given:
        name, equals, value = item.rpartition("=")
        if not equals:
            raise ArgumentError("--armature", item, "write name=number when giving several")
        named[name] = _plain("--armature", item, value)
    return named


def _plain(option: str, item: str, value: str) -> float:
    found = number(option, value)
    if not isinstance(found, float):
        raise ArgumentError(option, item, "write a number; draws are for the true arm's options")
    return found
