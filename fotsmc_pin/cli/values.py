"""Numbers as they are typed: one for all, `name=number`, or `low:high` to draw."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms.random_numbers import Number

Default = TypeVar("Default", float, None)
VALUE = "number, low:high, or name=either"
"""How `values_by_name` is typed, for a help text; `low:high` draws between the two."""


def values_by_name(
    option: str, given: Sequence[str] | None, default: Default
) -> Number | dict[str, Number] | Default:
    """Return one number for all, or a mapping by name, of options such as `link7=0.9:1.1`.

    Raises:
        ArgumentError: a text that is no number, or several without names.
    """
    if not given:
        return default
    if len(given) == 1 and "=" not in given[0]:
        return number(option, given[0])
    named: dict[str, Number] = {}
    for item in given:
        name, equals, value = item.rpartition("=")
        if not equals:
            raise ArgumentError(option, item, "write name=number when giving several")
        named[name] = number(option, value)
    return named


def number(option: str, text: str) -> Number:
    """Return the number that a text says, or the `Uniform` of `low:high`.

    Raises:
        ArgumentError: it says neither.
    """
    from fotsmc_pin.arms import Uniform

    low, colon, high = text.partition(":")
    try:
        ends = float(low), float(high if colon else low)
    except ValueError:
        raise ArgumentError(option, text, "write a number, or low:high to draw one") from None
    return Uniform(*ends) if colon else ends[0]


def plain_value(text: str) -> float | str | bool:
    """Return what a text says: a number, true, false, or a word."""
    try:
        return float(text)
    except ValueError:
        return {"true": True, "false": False}.get(text.lower(), text)
