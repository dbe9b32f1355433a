"""Gains as data: each field of a law's `Gains` carries its default, its unit and its bounds."""

from __future__ import annotations

import difflib
import math
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    G = TypeVar("G", bound="Gains")


def scalar(
    default: float,
    unit: str = "",
    *,
    above: float = -math.inf,
    below: float = math.inf,
    at_least: float = -math.inf,
) -> Any:
    """One number for the whole arm."""
    bounds = {"above": above, "below": below, "at_least": at_least}
    return field(default=default, metadata={"kind": "scalar", "unit": unit, "bounds": bounds})


def per_joint(
    default: float, unit: str = "", *, above: float = -math.inf, at_least: float = -math.inf
) -> Any:
    """One number per joint; a scalar stands for all of them."""
    bounds = {"above": above, "at_least": at_least}
    return field(default=default, metadata={"kind": "per joint", "unit": unit, "bounds": bounds})


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
        return cls(
            **{name: _checked(name, values[name], f.metadata, n) for name, f in known.items()}
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the gains as plain data; equal entries per joint fold into one number."""
        return {name: _plain(value) for name, value in asdict(self).items()}


def _checked(name: str, value: Any, metadata: Mapping[str, Any], n: int) -> Any:
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
