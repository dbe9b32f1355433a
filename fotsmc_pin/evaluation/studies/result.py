"""`StudyResult`: the metrics that a study collected, a row for each run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True)
class Row:
    """One finished run.

    Attributes:
        parameters: what was different in it.
        seed: its seed.
        metrics: its results by name; empty if it failed.
        error: why it failed; None if it did not.
        seconds: how long it took [s].
    """

    parameters: Mapping[str, Any]
    seed: int
    metrics: Mapping[str, float] = field(default_factory=dict)
    error: str | None = None
    seconds: float = 0.0


@dataclass(frozen=True)
class StudyResult:
    """All runs of a study, in the order of the grid and the draws.

    Attributes:
        rows: the runs, failed ones too.
    """

    rows: tuple[Row, ...]

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.rows)

    @property
    def failed(self) -> tuple[Row, ...]:
        """The runs that ended in an error."""
        return tuple(row for row in self.rows if row.error is not None)

    @property
    def succeeded(self) -> tuple[Row, ...]:
        """The runs that ended without an error."""
        return tuple(row for row in self.rows if row.error is None)

    def metric(self, name: str) -> Array:
        """Return one metric of every run that succeeded, (n,).

        Raises:
            ArgumentError: the runs have no metric of this name.
        """
        known = self.succeeded[0].metrics if self.succeeded else {}
        checks.choice("name", name, sorted(known))
        return np.array([row.metrics[name] for row in self.succeeded])

    def where(self, parameters: Mapping[str, Any]) -> StudyResult:
        """Return the runs with these parameters, such as one point of a grid."""
        return StudyResult(
            tuple(
                row
                for row in self.rows
                if all(row.parameters.get(name) == value for name, value in parameters.items())
            )
        )

    def worst(self, name: str, *, key: Callable[[float], float] = abs) -> Row:
        """Return the run whose metric is largest; not a number counts as worst of all.

        Args:
            name: the metric.
            key: what is compared of it; `operator.neg` finds the smallest value.

        Raises:
            ArgumentError: no run succeeded, or none has a metric of this name.
        """
        values = [key(value) for value in self.metric(name)]
        if not values:
            raise ArgumentError("name", name, "no run succeeded")
        badness = [np.inf if np.isnan(value) else value for value in values]
        return self.succeeded[int(np.argmax(badness))]

    def quantiles(self, name: str, levels: tuple[float, ...] = (0.05, 0.5, 0.95, 1.0)) -> Array:
        """Return quantiles of one metric; each is one of the runs, never a value between two."""
        return np.asarray(np.quantile(self.metric(name), levels, method="higher"))
