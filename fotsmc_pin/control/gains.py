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

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

    G = TypeVar("G", bound="Gains")

DERIVED = None
"""Default of a gain that `Gains.derive` computes from the arm and the period of a tick."""


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
    unlimited: bool = False,
    tuned: bool = True,
) -> Any:
    """One number per joint; a scalar stands for all of them.

    With the default `DERIVED` the law's `Gains.derive` computes what was not given. Where
    `unlimited`, inf is allowed. `tuned` tells whether a search of gains may move it.
    """
    bounds = {"above": above, "at_least": at_least, "unlimited": unlimited}
    metadata = {"kind": "per joint", "unit": unit, "bounds": bounds, "tuned": tuned}
    return field(default=default, metadata=metadata)


def option(default: str, choices: Sequence[str]) -> Any:
    """One word out of a few. A kernel sees its code, one of `codes(choices)`."""
    return field(default=default, metadata={"kind": "option", "choices": tuple(choices)})


def codes(choices: Sequence[str]) -> tuple[Any, ...]:
    """Return what stands for each choice of an option inside a kernel: its place among them."""
    return tuple(range(len(choices)))


def flag(default: bool) -> Any:
    """Switches one ingredient of a law on or off."""
    return field(default=default, metadata={"kind": "flag"})


class GainsType(type):
    """The class of every `Gains` class, by which a kernel knows them (see `rows`)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Gains(metaclass=GainsType):
    """Base of every law's gains. A law's own class lists its fields with their meaning.

    Values are checked when gains are made. A gain per joint is an array: of one number until
    `resolve` has spread it over the joints.

    Raises:
        ArgumentError: a value out of its bounds, or one that the controller has to derive.
    """

    def __post_init__(self) -> None:
        """Check every value, and turn numbers per joint into arrays."""
        for f in fields(self):
            value = getattr(self, f.name)
            if value is None:
                remedy = "give a value; a controller derives it from its arm and tick"
                raise ArgumentError(f.name, value, remedy)
            object.__setattr__(self, f.name, _checked(f, value))

    @classmethod
    def derive(cls, arm: Arm, dt: float, known: Mapping[str, Any]) -> dict[str, Any]:
        """Return the gains whose default is `DERIVED`, from the arm, the tick and other gains.

        Args:
            arm: the nominal arm.
            dt: nominal period of a tick [s].
            known: every other gain by name, checked.
        """
        return {}

    @classmethod
    def resolve(
        cls: type[G], arm: Arm, dt: float, preset: Mapping[str, Any], given: Mapping[str, Any]
    ) -> G:
        """Return checked gains with an entry per joint of `arm`: the preset, and over it `given`.

        Raises:
            ArgumentError: an unknown name, a value out of its bounds, or a wrong number of joints.
        """
        known = {f.name: f for f in fields(cls)}
        for name, value in given.items():
            if name not in known:
                near = difflib.get_close_matches(name, known, 1)
                hint = f"did you mean {near[0]}? " if near else ""
                raise ArgumentError(name, value, f"{hint}the gains are {', '.join(known)}")
        values = {name: f.default for name, f in known.items()} | dict(preset) | dict(given)
        values = {
            name: _checked(known[name], value, arm.nv)
            for name, value in values.items()
            if value is not DERIVED or known[name].default is not DERIVED
        }
        if len(values) < len(known):
            values = cls.derive(arm, dt, values) | values
        values = {name: _checked(f, values.get(name), arm.nv) for name, f in known.items()}
        return cls(**values)

    def rows(self, n: int) -> Array:
        """Return every gain as a row over `n` joints, in the order of the fields.

        An option is its code, a flag 0 or 1.
        """
        numbers = [_number(f, getattr(self, f.name)) for f in fields(self)]
        return np.array([np.broadcast_to(number, n) for number in numbers]).reshape(-1, n)

    def as_dict(self) -> dict[str, Any]:
        """Return the gains as plain data; equal entries per joint fold into one number."""
        return {name: _plain(value) for name, value in asdict(self).items()}


def _checked(found: Field[Any], value: Any, n: int | None = None) -> Any:
    """Return a clean value of one field; a gain per joint has `n` entries where that is given."""
    name, metadata = found.name, found.metadata
    match metadata["kind"]:
        case "scalar":
            return checks.finite_number(name, value, **metadata["bounds"])
        case "per joint":
            size = np.size(value) if n is None and np.ndim(value) == 1 else n or 1
            return checks.per_joint(name, value, size, **metadata["bounds"])
        case "option":
            return checks.choice(name, value, metadata["choices"])
        case _:
            if not isinstance(value, bool):
                raise ArgumentError(name, value, "give True or False")
            return value


def _number(found: Field[Any], value: Any) -> Any:
    """Return what stands for a value inside a kernel."""
    return found.metadata["choices"].index(value) if isinstance(value, str) else value


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return float(value[0]) if np.all(value == value[0]) else value.tolist()
    return value
