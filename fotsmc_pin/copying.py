"""Copies of objects that have state."""

from __future__ import annotations

import copy
from typing import TypeVar

T = TypeVar("T", bound="SharesNothing")


class SharesNothing:
    """Base of objects with state: a copy, shallow or deep, shares no memory with its original.

    `copy.copy` differs from `copy.deepcopy` only in that both go on to use the same arm, which
    never changes.
    """

    def __copy__(self: T) -> T:
        arm = getattr(self, "arm", None)
        return copy.deepcopy(self, {id(arm): arm})
