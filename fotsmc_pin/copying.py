"""Copies of objects that have state."""

from __future__ import annotations

import copy
from typing import Any, ClassVar, TypeVar

T = TypeVar("T", bound="SharesNothing")


class SharesNothing:
    """Base of objects with state: a copy, shallow or deep, shares no memory with its original.

    `copy.copy` differs from `copy.deepcopy` only in that both go on to use the same arm, which
    never changes.

    Class attributes:
        linked: names of the attributes that `_link` makes, such as views and compiled code; no copy
            and no pickle takes them along.
    """

    linked: ClassVar[frozenset[str]] = frozenset()

    def _link(self) -> None:
        """Make what only refers to the other attributes."""

    def __copy__(self: T) -> T:
        arm = getattr(self, "arm", None)
        return copy.deepcopy(self, {id(arm): arm})

    def __getstate__(self) -> dict[str, Any]:
        """Return all attributes but those that `_link` makes."""
        return {name: value for name, value in self.__dict__.items() if name not in self.linked}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._link()
