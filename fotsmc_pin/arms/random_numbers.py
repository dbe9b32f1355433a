"""Numbers that may be given or drawn at random, as the arguments of `perturb` are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np

from fotsmc_pin.checks import count, finite_number
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@dataclass(frozen=True)
class Uniform:
    """A number to be drawn between two bounds, anew for each link or joint.

    Attributes:
        low: lower bound.
        high: upper bound.

    Raises:
        ArgumentError: bounds that are not finite or in the wrong order.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        """Check the bounds."""
        low = finite_number("low", self.low)
        finite_number("high", self.high, at_least=low)


Number: TypeAlias = "float | Uniform"
PerLink: TypeAlias = "Number | Mapping[str, Number]"
Value = TypeVar("Value")


class RandomNumbers:
    """Random numbers from one seed, each purpose from its own stream.

    Changing one argument of a perturbation so leaves the draws of all others alone.
    """

    def __init__(self, seed: int | None) -> None:
        """Start with a seed; without one, whatever is drawn fails."""
        self.seed = None if seed is None else count("seed", seed, at_least=0)
        self.used = False

    def stream(self, purpose: str) -> RandomStream:
        """Return the stream of a purpose, always the same one for a seed."""
        return RandomStream(self, purpose)


class RandomStream:
    """Random numbers for one purpose."""

    def __init__(self, source: RandomNumbers, purpose: str) -> None:
        """Draw from the seed of `source`, and name `purpose` in messages."""
        self._source, self._purpose = source, purpose
        self._rng: np.random.Generator | None = None

    def number(self, given: Number) -> float:
        """Return the number given, or draw it."""
        if isinstance(given, Uniform):
            return float(self.rng.uniform(given.low, given.high))
        return finite_number(self._purpose, given)

    def direction(self) -> Array:
        """Return a unit vector, (3,), every direction alike."""
        vector = self.rng.normal(size=3)
        return np.asarray(vector / np.linalg.norm(vector))

    @property
    def rng(self) -> np.random.Generator:
        """The generator; asking for it demands a seed."""
        if self._source.seed is None:
            raise ArgumentError("seed", None, f"{self._purpose} is drawn at random: give a seed")
        if self._rng is None:
            key = [self._source.seed, *self._purpose.encode()]
            self._rng = np.random.default_rng(key)
            self._source.used = True
        return self._rng


def spread(
    argument: str, given: Value | Mapping[str, Value], names: Sequence[str], what: str
) -> dict[str, Value]:
    """Return what is given for each name, from one value or a mapping by names or patterns."""
    if not isinstance(given, Mapping):
        return dict.fromkeys(names, given)
    values: dict[str, Value] = {}
    for pattern, value in given.items():
        matches = [name for name in names if fnmatchcase(name, pattern)]
        if not matches:
            raise ArgumentError(
                argument, pattern, f"no {what} has this name; known: {', '.join(names)}"
            )
        values.update(dict.fromkeys(matches, value))
    return values
