"""The condition `1 < p/q < 2`, which the paper's proof demands and its simulation breaks (R2)."""

from __future__ import annotations

import warnings


class PaperConditionWarning(UserWarning):
    """The chosen gains break a condition that the paper's own proof demands."""


def obeys_power_condition(power: float) -> bool:
    """Return whether `1 < p/q < 2`, so that `|e|^{p/q-1}` in [20] is bounded at `e = 0`.

    Args:
        power: `p/q` of the surface [19].

    Source: the text below [19]; the paper simulates 0.9 (reading R2).
    """
    return 1.0 < power < 2.0


def warn_of_power(power: float, error_floor: float, stacklevel: int) -> None:
    """Warn where `p/q` breaks the condition, and say what holds the law together there."""
    if not obeys_power_condition(power):
        warnings.warn(
            f"power = {power:g} breaks the condition 1 < p/q < 2 that the paper's proof demands: "
            f"|e|^(p/q-1) is singular at e = 0 and is held by error_floor = {error_floor:g}",
            PaperConditionWarning,
            stacklevel=stacklevel + 1,
        )
