"""The memory of a controller as plain arrays by name, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.checks import finite_array
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.fractional import Stream
    from fotsmc_pin.types import Array

GIVEN = {"effort_limit"}
"""Rows of the joints that are not remembered: they belong to the arm."""


def saved(groups: Mapping[str, Any], streams: Mapping[str, Stream]) -> dict[str, Array]:
    """Return copies of all rows and of all streams.

    Args:
        groups: named rows by the name of their group.
        streams: the running streams by name.
    """
    arrays = {name: row.copy() for name, row in _rows(groups).items()}
    for name, stream in streams.items():
        arrays |= {f"{name}.{part}": array for part, array in stream.to_arrays().items()}
    return arrays


def restore(
    arrays: Mapping[str, ArrayLike], groups: Mapping[str, Any], streams: Mapping[str, Stream]
) -> None:
    """Write what `saved` gave back into rows and streams; all of it, or nothing.

    Raises:
        ArgumentError: an array is missing, unknown, of the wrong shape or not finite.
    """
    rows = _rows(groups)
    parts = {f"{name}.{part}": name for name, s in streams.items() for part in s.to_arrays()}
    if set(arrays) != {*rows, *parts}:
        odd = sorted(set(arrays) ^ {*rows, *parts})
        raise ArgumentError("arrays", sorted(arrays), f"missing or unknown: {', '.join(odd)}")
    clean = {name: finite_array(name, arrays[name], row.shape) for name, row in rows.items()}
    twins = {name: stream.copy() for name, stream in streams.items()}
    for name, twin in twins.items():
        twin.from_arrays({part: arrays[f"{name}.{part}"] for part in twin.to_arrays()})
    for name, row in rows.items():
        row[:] = clean[name]
    for name, stream in streams.items():
        stream.from_arrays(twins[name].to_arrays())


def present(arrays: Mapping[str, Any], name: str) -> Any:
    """Return one of the arrays.

    Raises:
        ArgumentError: it is not there.
    """
    if name not in arrays:
        raise ArgumentError("arrays", sorted(arrays), f"give {name} too, as save_state does")
    return arrays[name]


def with_prefix(prefix: str, arrays: Mapping[str, Array]) -> dict[str, Array]:
    """Return the arrays of a part under names that tell whose they are."""
    return {f"{prefix}.{name}": array for name, array in arrays.items()}


def part(arrays: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """Return the arrays of a part, by the names that it gave them."""
    start = f"{prefix}."
    return {
        name.removeprefix(start): array for name, array in arrays.items() if name.startswith(start)
    }


def _rows(groups: Mapping[str, Any]) -> dict[str, Array]:
    return {
        f"{group}.{name}": row
        for group, rows in groups.items()
        for name, row in rows._asdict().items()
        if name not in GIVEN
    }
