"""Checks of the input of the public API: numbers in, clean arrays out, or an `ArgumentError`."""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array


def instance(name: str, value: object, kind: type | tuple[type, ...], remedy: str) -> None:
    """Demand that `value` is of a kind.

    Raises:
        ArgumentError: naming the argument, its value and the remedy.
    """
    if not isinstance(value, kind):
        raise ArgumentError(name, value, remedy)


def finite_number(
    name: str,
    value: float,
    *,
    above: float = -math.inf,
    below: float = math.inf,
    at_least: float = -math.inf,
    at_most: float = math.inf,
) -> float:
    """Return `value` as a float inside the given bounds.

    Raises:
        ArgumentError: naming the argument, its value and the bounds.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(name, value, "give a number") from None
    if not math.isfinite(number):
        raise ArgumentError(name, value, "give a finite number")
    if not (above < number < below and at_least <= number <= at_most):
        bounds = [
            f"{word} {bound:g}"
            for word, bound in (
                ("above", above),
                ("at least", at_least),
                ("below", below),
                ("at most", at_most),
            )
            if math.isfinite(bound)
        ]
        raise ArgumentError(name, value, f"give a number {' and '.join(bounds)}")
    return number


def count(name: str, value: int, *, at_least: int = 1) -> int:
    """Return `value` as an int of at least `at_least`; a bool or a fraction is refused."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise ArgumentError(name, value, "give a whole number")
    if value < at_least:
        raise ArgumentError(name, value, f"give a whole number of at least {at_least}")
    return int(value)


def finite_vector(name: str, value: ArrayLike, size: int) -> Array:
    """Return a fresh float64 vector of shape `(size,)` with finite entries."""
    return finite_array(name, value, (size,))


def finite_array(
    name: str, value: ArrayLike, shape: tuple[int, ...], *, unlimited: bool = False
) -> Array:
    """Return a fresh float64 array of this shape with finite entries, or inf where `unlimited`."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArgumentError(name, value, f"give numbers, of shape {shape}") from None
    if array.shape != shape:
        raise ArgumentError(name, value, f"give shape {shape}, not {array.shape}")
    if not (np.isfinite(array) | (unlimited & (array == np.inf))).all():
        raise ArgumentError(name, value, "every entry must be finite")
    return array


def per_joint(
    name: str,
    value: ArrayLike,
    size: int,
    *,
    above: float = -math.inf,
    at_least: float = -math.inf,
    unlimited: bool = False,
) -> Array:
    """Return a vector with one entry per joint; a scalar is used for every joint.

    Where `unlimited`, inf is allowed.
    """
    if np.ndim(value) == 0:
        value = np.full(size, value)
    vector = finite_array(name, value, (size,), unlimited=unlimited)
    if not (np.all(vector > above) and np.all(vector >= at_least)):
        word = f"above {above:g}" if math.isfinite(above) else f"at least {at_least:g}"
        raise ArgumentError(name, value, f"every entry must be {word}")
    return vector


def choice(name: str, value: str, known: Sequence[str]) -> str:
    """Return `value` if it is one of the known values; the message names the nearest one."""
    if value not in known:
        hint = did_you_mean(value, known)
        raise ArgumentError(name, value, f"{hint}choose one of {', '.join(known)}")
    return value


def did_you_mean(value: object, known: Iterable[str]) -> str:
    """Return a question that names the known word nearest to `value`, empty if none is near."""
    lower = {word.lower(): word for word in known}
    near = difflib.get_close_matches(str(value).lower(), lower, 1)
    return f"did you mean {lower[near[0]]}? " if near else ""
