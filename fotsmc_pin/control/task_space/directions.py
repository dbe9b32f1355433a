"""The directions in which a task holds the tool."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from fotsmc_pin.types import Array

WAYS, TURNS = ("x", "y", "z"), ("rx", "ry", "rz")
WORDS: dict[str, tuple[str, ...]] = {
    "all": WAYS + TURNS,
    "position": WAYS,
    "orientation": TURNS,
    "plane": ("x", "y"),
    "axis": ("z",),
    "pointing": (*WAYS, "rx", "ry"),
}
"""Directions that have a word of their own."""


@dataclass(frozen=True)
class Directions:
    """Which directions of the reference frame a task holds.

    Attributes:
        names: "x", "y", "z" for positions, "rx", "ry", "rz" for rotations.
    """

    names: tuple[str, ...]

    @classmethod
    def read(cls, given: str | Iterable[str]) -> Directions:
        """Return what a word of `WORDS` stands for, or the named directions in order.

        Raises:
            ArgumentError: an unknown name, none at all, or one rotation alone.
        """
        names = WORDS.get(given, (given,)) if isinstance(given, str) else tuple(given)
        known = WORDS["all"]
        if not names or not set(names) <= set(known):
            remedy = f"choose {', '.join(WORDS)}, or some of {', '.join(known)}"
            raise ArgumentError("directions", given, remedy)
        ordered = tuple(name for name in known if name in names)
        if sum(name in TURNS for name in ordered) == 1:
            remedy = "choose no rotation, all three, or two, which point the third axis"
            raise ArgumentError("directions", given, remedy)
        return cls(ordered)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.names)

    @property
    def are_rotations(self) -> NDArray[np.bool_]:
        """Return which of them are rotations (m,)."""
        return np.array([name in TURNS for name in self.names])

    @property
    def code(self) -> NDArray[np.int64]:
        """Return what `error_of` reads (6,).

        Whether all six are held; each of x, y, z; 0 for no rotation, 1 for all, 2 for a swing; and
        the axis that a swing points.
        """
        turns = [name for name in TURNS if name in self.names]
        kind = {0: 0, 2: 2, 3: 1}[len(turns)]
        axis = next((k for k, name in enumerate(TURNS) if name not in turns), 0)
        ways = [int(name in self.names) for name in WAYS]
        return np.array([int(len(self) == 6), *ways, kind, axis if kind == 2 else 0])

    def scale(self, length: float) -> Array:
        """Return the factors that make each a way (m,): 1, or a length per radian [m]."""
        return np.where(self.are_rotations, length, 1.0)
