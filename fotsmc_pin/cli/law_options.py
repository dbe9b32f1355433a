"""The options about a control law and its gains, the same on every command that runs one."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.values import plain_value
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller

PANEL = "The controller"
DEFAULT_LAW = "RobustFONFTSM"


def complete_law(incomplete: str) -> list[str]:
    """Return the names of laws that begin like this, for the shell's completion."""
    from fotsmc_pin.control import CONTROLLERS

    return [name for name in CONTROLLERS if name.lower().startswith(incomplete.lower())]


@dataclass(frozen=True, kw_only=True)
class LawOptions:
    """A law and its gains, as typed; `make` makes the controller."""

    controller: Annotated[
        str | None,
        typer.Option(
            help=f"Name of the control law. [default: {DEFAULT_LAW}, or the law of --gains]",
            rich_help_panel=PANEL,
            metavar="LAW",
            autocompletion=complete_law,
        ),
    ] = None
    preset: Annotated[
        str | None,
        typer.Option(
            help="Set of gains; see the law's page.", rich_help_panel=PANEL, metavar="NAME"
        ),
    ] = None
    gain: Annotated[
        list[str] | None,
        typer.Option(
            help="A single gain, a number or a word; may be repeated.",
            metavar="NAME=VALUE",
            rich_help_panel=PANEL,
        ),
    ] = None
    gains: Annotated[
        str | None,
        typer.Option(
            help="Gains that `fotsmc tune` found: its front.json, FILE#n for its n-th point; or a "
            "JSON file of gains by name.",
            metavar="FILE[#n]",
            rich_help_panel=PANEL,
        ),
    ] = None

    def make(self, arm: Arm, dt: float) -> Controller[Any]:
        """Make the controller; a law by name runs with its preset for practice.

        Raises:
            ArgumentError: an unknown law, preset or gain, or a file that holds none.
        """
        from fotsmc_pin.checks import choice
        from fotsmc_pin.control import CONTROLLERS
        from fotsmc_pin.evaluation.stress.suite import law_maker

        found, of_law = ({}, None) if self.gains is None else read_gains(self.gains)
        name = choice("--controller", self.controller or of_law or DEFAULT_LAW, [*CONTROLLERS])
        if of_law not in (None, name):
            raise ArgumentError("--gains", self.gains, f"holds gains of {of_law}, not of {name}")
        law = CONTROLLERS[name]
        preset = self.preset
        if preset is None:
            preset = law_maker(law)(arm, dt).preset
        return law(arm, dt, preset=preset, **(found | _single(self.gain or [])))


def _single(pairs: list[str]) -> dict[str, Any]:
    gains: dict[str, Any] = {}
    for pair in pairs:
        name, equals, value = pair.partition("=")
        if not equals:
            raise ArgumentError("--gain", pair, "write name=value")
        gains[name] = plain_value(value)
    return gains


def read_gains(given: str) -> tuple[dict[str, Any], str | None]:
    """Return gains by name from a file, and the law that they are of, where it says so.

    Args:
        given: `FILE`, or `FILE#n` for the n-th point of a front, counted from 1.

    Raises:
        ArgumentError: the file holds no gains, or no n-th point.
        FileNotFoundError: no such file.
    """
    path, mark, number = given.partition("#")
    try:
        data = json.loads(Path(path).read_text("utf-8"))
    except (ValueError, UnicodeDecodeError) as error:
        raise ArgumentError("--gains", given, f"not a JSON file: {error}") from None
    if isinstance(data, dict) and isinstance(points := data.get("front"), list):
        try:
            n = int(number) if mark else 1
            if n < 1:
                raise IndexError
            return _gains(given, points[n - 1]["gains"]), data.get("law")
        except (IndexError, KeyError, TypeError, ValueError):
            remedy = f"give FILE#n with n from 1 to {len(points)}"
            raise ArgumentError("--gains", given, remedy) from None
    if mark:
        raise ArgumentError("--gains", given, "the file holds one set of gains; leave #n out")
    return _gains(given, data), None


def _gains(given: str, data: Mapping[str, Any]) -> dict[str, Any]:
    if not isinstance(data, dict):
        raise ArgumentError("--gains", given, "give gains by name, as {...} in JSON")
    return dict(data)
