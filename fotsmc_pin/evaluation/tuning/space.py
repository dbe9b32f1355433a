"""What a search of gains may draw: one rule for every law, from the fields of its `Gains`.

A number that is bounded on both sides is drawn evenly over its bounds; any other evenly in its
logarithm, from a tenth of its start to ten times it. What its field exempts (`tuned=False`),
options, flags and numbers that start at 0 stay as they are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.control import Controller

DECADE = 10.0
MARGIN = 0.02
"""Share of an interval that is kept clear at both ends, where a law may be singular."""


@dataclass(frozen=True, kw_only=True)
class Span:
    """The interval from which one gain is drawn.

    Attributes:
        low: smallest value.
        high: largest value.
        logarithmic: drawn evenly in the logarithm.
    """

    low: float
    high: float
    logarithmic: bool


def search_space(law: type[Controller], start: Mapping[str, Any]) -> dict[str, Span]:
    """Return the span of every gain of `law` that a search may draw.

    Args:
        law: the control law.
        start: gains from which the search starts, where they differ from the defaults.
    """
    space = {}
    for field in fields(law.Gains):
        if field.metadata["kind"] in ("scalar", "per joint") and field.metadata["tuned"]:
            span = _span(start.get(field.name, field.default), field.metadata["bounds"])
            if span is not None:
                space[field.name] = span
    return space


def _span(start: Any, bounds: Mapping[str, float]) -> Span | None:
    low = max(bounds.get("above", -math.inf), bounds.get("at_least", -math.inf))
    high = bounds.get("below", math.inf)
    if math.isfinite(low) and math.isfinite(high):
        margin = MARGIN * (high - low)
        return Span(low=low + margin, high=high - margin, logarithmic=False)
    if not isinstance(start, (int, float)) or start <= 0.0:
        return None
    return Span(low=start / DECADE, high=start * DECADE, logarithmic=True)
