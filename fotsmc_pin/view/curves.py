"""Curves thinned for drawing without losing their extremes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


ROWS_AT_MOST = 12_000


def thinned_curves(
    t: Array, columns: Array, rows_at_most: int = ROWS_AT_MOST
) -> tuple[Array, Array]:
    """Return times and columns with at most `rows_at_most` rows that draw the same picture.

    Short recordings come back as they are. In longer ones, each stretch of samples becomes two
    rows, with the lowest and the highest value of each column in the order in which they came, so
    that peaks and chattering keep their height; the first and last samples stay.

    Args:
        t: times (N,) [s].
        columns: values (N, k).
        rows_at_most: limit of the result, at least 4.
    """
    if len(t) <= rows_at_most:
        return t, columns
    inner = np.arange(1, len(t) - 1)
    width = -(-len(inner) // ((rows_at_most - 2) // 2))
    times, values = [t[:1]], [columns[:1]]
    whole = len(inner) // width * width
    for start, stop in ((1, 1 + whole), (1 + whole, len(t) - 1)):
        if start == stop:
            continue
        size = min(width, stop - start)
        stretches = columns[start:stop].reshape(-1, size, columns.shape[1])
        low, high = stretches.min(axis=1), stretches.max(axis=1)
        falling = stretches.argmax(axis=1) < stretches.argmin(axis=1)
        pair = [np.where(falling, high, low), np.where(falling, low, high)]
        values.append(np.stack(pair, axis=1).reshape(-1, columns.shape[1]))
        begins = np.arange(start, stop, size)
        times.append(t[np.stack([begins, begins + size // 2], axis=1).ravel()])
    times.append(t[-1:])
    values.append(columns[-1:])
    return np.concatenate(times), np.concatenate(values)
