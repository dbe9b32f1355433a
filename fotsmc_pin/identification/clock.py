"""The clock of a log: stamps that repeat, run backwards, leave gaps or wander."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fotsmc_pin.errors import LogError
from fotsmc_pin.types import Array  # noqa: TC001 - a NamedTuple's fields are evaluated

BRIDGED = 5.0
"""A gap of up to so many periods is bridged by straight lines; a longer one parts the log."""
MISSING = 1.5
"""Beyond so many periods between two rows one is missing."""
EVEN = 0.01
"""Rows count as evenly spaced if none is off its place by more than this share of a period."""
BACKWARDS = 0.01
"""Share of the rows that may come before their time, as messages on a network do."""
LEAST = 20
"""Rows that a log, and each piece between gaps, must have."""


class Steady(NamedTuple):
    """Rows at even times, but for gaps.

    Attributes:
        t: time (T,) [s], from the first stamp on.
        columns: rows at these times (T, k).
        notes: what was found and done, in plain words.
        alarming: those of the notes that a user should look at.
    """

    t: Array
    columns: Array
    notes: list[str]
    alarming: list[str]


def steady(source: str, t: Array, columns: Array) -> Steady:
    """Return rows at even times between gaps: each stamp once, in order.

    Rows that are evenly spaced stay as they are; others are resampled at the median period, by
    straight lines between neighbours. Nothing is drawn across a gap of more than `BRIDGED` periods.

    Args:
        source: what to call the log.
        t: stamps (N,) [s].
        columns: rows (N, k).

    Raises:
        LogError: too few rows, or stamps that run backwards again and again.
    """
    notes: list[str] = []
    alarming: list[str] = []
    _demand_rows(source, t, "it has")
    t, columns = _in_order(source, t, columns, alarming)
    t, columns = _each_once(t, columns, alarming)
    _demand_rows(source, t, "without repeated stamps it has")
    period = float(np.median(np.diff(t)))
    parts = _pieces(t, period, alarming)
    if not parts:
        raise LogError(
            "clock", f"{source}: no {LEAST} rows in a row without a gap; record it again"
        )
    pieces = [_even(t[part], columns[part], period, notes) for part in parts]
    even, rows = (np.concatenate(side) for side in zip(*pieces, strict=True))
    return Steady(even, rows, list(dict.fromkeys(notes)) + alarming, alarming)


def _demand_rows(source: str, t: Array, what: str) -> None:
    if len(t) < LEAST:
        raise LogError("clock", f"{source}: {what} {len(t)} rows, and at least {LEAST} are needed")


def _in_order(source: str, t: Array, columns: Array, alarming: list[str]) -> tuple[Array, Array]:
    back = np.flatnonzero(np.diff(t) < 0.0)
    if not back.size:
        return t, columns
    if back.size > BACKWARDS * len(t) or float(-np.diff(t)[back].min()) > 1.0:
        row = int(back[0])
        raise LogError(
            "clock",
            f"{source}: stamps run backwards, first from {t[row]:.6g} to {t[row + 1]:.6g} s "
            f"(row {row + 2}): were two logs joined, or the clock set? Read them one by one",
        )
    order = np.argsort(t, kind="stable")
    alarming.append(f"{back.size} rows came after later ones and were put in order")
    return t[order], columns[order]


def _each_once(t: Array, columns: Array, alarming: list[str]) -> tuple[Array, Array]:
    repeated = np.flatnonzero(np.diff(t) == 0.0) + 1
    if not repeated.size:
        return t, columns
    same = np.all(columns[repeated] == columns[repeated - 1], axis=1)
    alarming.append(
        f"{repeated.size} stamps stand twice, first {t[repeated[0]]:.6g} s "
        f"({int(same.sum())} of them with the same numbers); the first row of each was kept"
    )
    kept = np.ones(len(t), dtype=bool)
    kept[repeated] = False
    return t[kept], columns[kept]


def _pieces(t: Array, period: float, alarming: list[str]) -> list[slice]:
    """Return the pieces between gaps, those that are long enough."""
    steps = np.diff(t)
    short = np.flatnonzero((steps > MISSING * period) & (steps <= BRIDGED * period))
    if short.size:
        lost = int(np.round(steps[short] / period - 1.0).sum())
        alarming.append(
            f"{lost} rows are missing in {short.size} gaps of up to {1e3 * steps[short].max():.4g} "
            f"ms, first at {t[short[0]]:.6g} s; bridged by straight lines"
        )
    wide = np.flatnonzero(steps > BRIDGED * period)
    ends = [0, *(wide + 1).tolist(), len(t)]
    parts = [slice(a, b) for a, b in pairwise(ends)]
    kept = [part for part in parts if part.stop - part.start >= LEAST]
    if wide.size:
        at = ", ".join(f"{steps[k]:.4g} s at {t[k]:.6g} s" for k in wide[:3])
        more = f" and {wide.size - 3} more" if wide.size > 3 else ""
        lost = sum(part.stop - part.start for part in parts if part not in kept)
        left = f", {lost} rows in shorter ones are left out" if lost else ""
        alarming.append(
            f"the clock has gaps ({at}{more}): {len(kept)} pieces are used one by one{left}"
        )
    return kept


def _even(t: Array, columns: Array, period: float, notes: list[str]) -> tuple[Array, Array]:
    mean = float((t[-1] - t[0]) / (len(t) - 1))
    off = np.abs(t - t[0] - mean * np.arange(len(t))).max() / mean
    if off < EVEN:
        notes.append(f"{len(t)} rows, {1.0 / mean:.6g} a second, evenly spaced: not resampled")
        return t, columns
    count = int(np.floor((t[-1] - t[0]) / period * (1.0 + 1e-12))) + 1
    even = t[0] + period * np.arange(count)
    steps = np.diff(t)
    notes.append(
        f"{len(t)} rows {1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms apart, resampled at "
        f"{1.0 / period:.6g} a second by straight lines"
    )
    rows = np.column_stack([np.interp(even, t, column) for column in columns.T])
    return even, rows
