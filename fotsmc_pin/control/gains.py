"""Gains as data: each field of a law's `Gains` carries its default, its unit and its bounds."""

from __future__ import annotations

import difflib
import math
from dataclasses import Field, asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    G = TypeVar("G", bound="Gains")


def scalar(
    default: float,
    unit: str = "",
    *,
    above: float = -math.inf,
    below: float = math.inf,
    at_least: float = -math.inf,
    tuned: bool = True,
) -> Any:
    """One number for the whole arm; `tuned` tells whether a search of gains may move it."""
    bounds = {"above": above, "below": below, "at_least": at_least}
    metadata = {"kind": "scalar", "unit": unit, "bounds": bounds, "tuned": tuned}
    return field(default=default, metadata=metadata)


def per_joint(
    default: float | None,
    unit: str = "",
    *,
    above: float = -math.inf,
    at_least: float = -math.inf,
    tuned: bool = True,
) -> Any:
    """One number per joint; a scalar stands for all of them.

    With a default of None the law finds the numbers itself where none are given. `tuned` tells
    whether a search of gains may move it.
    """
    bounds = {"above": above, "at_least": at_least}
    metadata = {"kind": "per joint", "unit": unit, "bounds": bounds, "tuned": tuned}
    return field(default=default, metadata=metadata)


def option(default: str, choices: Sequence[str]) -> Any:
    """One word out of a few."""
    return field(default=default, metadata={"kind": "option", "choices": tuple(choices)})


def flag(default: bool) -> Any:
    """Switches one ingredient of a law on or off."""
    return field(default=default, metadata={"kind": "flag"})


@dataclass(frozen=True, kw_only=True, eq=False)
class Gains:
    """Base of every law's gains. A law's own class lists its fields with their meaning."""

    @classmethod
    def resolve(cls: type[G], n: int, preset: Mapping[str, Any], given: Mapping[str, Any]) -> G:
        """Return checked gains for `n` joints: the preset, and over it what was given.

        Raises:
            ArgumentError: an unknown name, or a value out of its bounds.
        """
        known = {f.name: f for f in fields(cls)}
        for name, value in given.items():
            if name not in known:
                near = difflib.get_close_matches(name, known, 1)
                hint = f"did you mean {near[0]}? " if near else ""
                raise ArgumentError(name, value, f"{hint}the gains are {', '.join(known)}")
        values = {name: f.default for name, f in known.items()} | dict(preset) | dict(given)
        return cls(**{name: _checked(name, values[name], f, n) for name, f in known.items()})

    def numbers(self) -> list[Any]:
        """Return the numeric gains in the order of their fields, options left out."""
        numeric = ("scalar", "per joint")
        return [getattr(self, f.name) for f in fields(self) if f.metadata["kind"] in numeric]

    def as_dict(self) -> dict[str, Any]:
        """Return the gains as plain data; equal entries per joint fold into one number."""
        return {name: _plain(value) for name, value in asdict(self).items()}


def _checked(name: str, value: Any, found: Field[Any], n: int) -> Any:
    metadata = found.metadata
    if value is None and found.default is None:
        return None
    match metadata["kind"]:
        case "scalar":
            return checks.finite_number(name, value, **metadata["bounds"])
        case "per joint":
            return checks.per_joint(name, value, n, **metadata["bounds"])
        case "option":
            return checks.choice(name, value, metadata["choices"])
        case _:
            if not isinstance(value, bool):
                raise ArgumentError(name, value, "give True or False")
            return value


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return float(value[0]) if np.all(value == value[0]) else value.tolist()
    return value
