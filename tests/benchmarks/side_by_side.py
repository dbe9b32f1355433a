"""Ratios that a drifting machine does not spoil: short blocks of every candidate, in turn."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


@dataclass(frozen=True)
class Timings:
    """Processor time of each candidate, a value for each round [s per call]."""

    rounds: Mapping[str, list[float]]

    def median(self, name: str) -> float:
        return statistics.median(self.rounds[name])

    def ratio(self, name: str, base: str) -> float:
        """Median over the rounds of the ratio within a round."""
        pairs = zip(self.rounds[name], self.rounds[base], strict=True)
        return statistics.median(one / other for one, other in pairs)


def side_by_side(
    candidates: Mapping[str, Callable[[], object]],
    *,
    calls: int,
    rounds: int,
    clock: Callable[[], float] = time.process_time,
) -> Timings:
    """Time blocks of `calls` calls of every candidate, one after the other, `rounds` times over.

    The clock counts this process's own processor time: what other programs take does not count.
    """
    for candidate in candidates.values():
        candidate()
    spent: dict[str, list[float]] = {name: [] for name in candidates}
    for _ in range(rounds):
        for name, candidate in candidates.items():
            started = clock()
            for _ in range(calls):
                candidate()
            spent[name].append((clock() - started) / calls)
    return Timings(spent)
