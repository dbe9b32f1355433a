"""Comparing sets of trials: fronts, hypervolumes, and paired bootstrap intervals.

All quantities are small when good. Nothing here knows what was run.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fotsmc_pin.types import Array

DRAWS = 10_000
LEVEL = 0.95


class Interval(NamedTuple):
    """An estimate and the bounds of its 95 % interval."""

    value: float
    low: float
    high: float

    def excludes(self, value: float) -> bool:
        """Return whether a value lies outside."""
        return not self.low <= value <= self.high

    def mapped(self, function: Callable[[float], float]) -> Interval:
        """Return the interval of a rising function of the estimate."""
        return Interval(*(function(x) for x in self))


def front(points: Array) -> Array:
    """Return the rows of those of the points (n, 2) that no other dominates, by the first number.

    A point dominates another if it is at most as large in both numbers and smaller in one. Of
    equal points one is kept; points that are not finite are left out.
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    kept, lowest = [], math.inf
    for row in order.tolist():
        if np.isfinite(points[row]).all() and points[row, 1] < lowest:
            kept.append(row)
            lowest = points[row, 1]
    return np.array(kept, dtype=np.intp)


def hypervolume(points: Array, reference: Sequence[float]) -> float:
    """Return the area that the points (n, 2) dominate, up to a reference point."""
    area, ceiling = 0.0, float(reference[1])
    for x, y in points[front(points)].tolist():
        if x < reference[0] and y < ceiling:
            area += (reference[0] - x) * (ceiling - y)
            ceiling = y
    return area


def paired_interval(differences: Array, *, seed: int = 0, draws: int = DRAWS) -> Interval:
    """Return the mean of paired differences (n,) with its bootstrap interval.

    The differences are drawn anew with replacement. Their deviations from the mean are widened by
    `√(n / (n-1))`, as the spread of a small sample is too small by that.
    """
    rng = np.random.default_rng(seed)
    n = len(differences)
    mean = float(np.mean(differences))
    if n < 2:
        return Interval(mean, -math.inf, math.inf)
    means = differences[rng.integers(n, size=(draws, n))].mean(axis=1)
    return _interval(mean, mean + math.sqrt(n / (n - 1)) * (means - mean))


def pooled_interval(groups: Sequence[Array], *, seed: int = 0, draws: int = DRAWS) -> Interval:
    """Return the mean of the groups' means with an interval that holds for other groups too.

    Groups (arms) are drawn with replacement, and in each of them its paired differences.
    """
    rng = np.random.default_rng(seed)
    m = len(groups)
    mean = float(np.mean([group.mean() for group in groups]))
    if m < 2:
        return paired_interval(groups[0], seed=seed, draws=draws)
    within = np.empty((m, draws))
    for row, group in enumerate(groups):
        n = len(group)
        widened = math.sqrt(n / (n - 1)) if n > 1 else 1.0
        means = group[rng.integers(n, size=(draws, n))].mean(axis=1)
        within[row] = group.mean() + widened * (means - group.mean())
    means = within[rng.integers(m, size=(draws, m)), np.arange(draws)[:, None]].mean(axis=1)
    return _interval(mean, mean + math.sqrt(m / (m - 1)) * (means - mean))


def hypervolume_difference(
    ours: Array, others: Array, *, seed: int = 0, draws: int = DRAWS // 10
) -> Interval:
    """Return by how much our front dominates more than the others', on the mean of the settings.

    Args:
        ours: points of our designs in each setting (designs, settings, 2), logarithms.
        others: points of the other designs in the same settings (designs, settings, 2).
        seed: of the draws.
        draws: how many there are.

    Returns:
        The difference of both hypervolumes, in the squared unit of the points, with the interval
        that drawing the settings anew gives. The reference point is the largest mean of all
        designs in either number.
    """
    rng = np.random.default_rng(seed)
    settings = ours.shape[1]
    corner = np.concatenate([ours.mean(axis=1), others.mean(axis=1)]).max(axis=0)

    def difference(drawn: Array) -> float:
        a, b = (hypervolume(x[:, drawn].mean(axis=1), corner) for x in (ours, others))
        return a - b

    value = difference(np.arange(settings))
    found = [difference(rng.integers(settings, size=settings)) for _ in range(draws)]
    widened = math.sqrt(settings / max(settings - 1, 1))
    return _interval(value, value + widened * (np.array(found) - value))


def _interval(value: float, drawn: Array) -> Interval:
    low, high = np.quantile(drawn, ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0))
    return Interval(value, float(low), float(high))
