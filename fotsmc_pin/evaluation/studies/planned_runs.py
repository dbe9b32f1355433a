"""`PlannedRun`: one run of a study; and all those that a grid and random draws make."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import Uniform
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

Grid: TypeAlias = Mapping[str, Sequence[Any]]
Distributions: TypeAlias = Mapping[str, "Uniform | Sequence[Any]"]


@dataclass(frozen=True, kw_only=True)
class PlannedRun:
    """One run: what is different in it, and where its random numbers come from.

    Attributes:
        parameters: names and plain values (numbers, words, lists of them).
        seed: seed of this run.
    """

    parameters: Mapping[str, Any]
    seed: int

    def key(self, run: str) -> str:
        """Return a digest of the planned run and of the name of what is run."""
        text = json.dumps([run, dict(self.parameters), self.seed], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def planned_runs(grid: Grid, draws: Distributions, repeats: int, seed: int) -> list[PlannedRun]:
    """Return every point of `grid`, each with `repeats` draws.

    The draw of a name depends on the seed, the number of the repeat and the name alone. So all
    points of the grid meet the same draws and can be compared one by one, more repeats go on
    where fewer ended, and another name more changes no draw.

    Raises:
        ArgumentError: no values for a name, a value that is no plain data, or a name in both.
    """
    seed = checks.count("seed", seed, at_least=0)
    repeats = checks.count("repeats", repeats)
    grid, draws = _plain(grid), _plain(draws)
    both = grid.keys() & draws.keys()
    if both:
        raise ArgumentError("draws", sorted(both), "put each name into `grid` or `draws`, not both")
    for argument, table in (("grid", grid), ("draws", draws)):
        for name, values in table.items():
            _check(f"{argument} {name!r}", values, drawn=table is draws)
    return [
        PlannedRun(parameters={**point, **_draw(draws, seed, repeat)}, seed=_run_seed(seed, repeat))
        for point in _points(grid)
        for repeat in range(repeats)
    ]


def probes(grid: Grid, draws: Distributions) -> Iterator[dict[str, Any]]:
    """Yield parameters that try every value of a grid, each with the draws at all their ends.

    A `Uniform` has two ends; of a list each value is one.
    """
    ends = {
        name: [values.low, values.high] if isinstance(values, Uniform) else list(values)
        for name, values in _plain(draws).items()
    }
    most = max(map(len, ends.values()), default=1)
    for point in _points(_plain(grid)):
        for k in range(most):
            yield {**point, **{name: values[k % len(values)] for name, values in ends.items()}}


def _plain(table: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: values.tolist() if isinstance(values, np.ndarray) else values
        for name, values in table.items()
    }


def _points(grid: Grid) -> Iterator[dict[str, Any]]:
    for values in itertools.product(*grid.values()):
        yield dict(zip(grid, values, strict=True))


def _draw(draws: Distributions, seed: int, repeat: int) -> dict[str, Any]:
    drawn: dict[str, Any] = {}
    for name, values in draws.items():
        rng = np.random.default_rng([seed, repeat, *name.encode()])
        if isinstance(values, Uniform):
            drawn[name] = float(rng.uniform(values.low, values.high))
        else:
            drawn[name] = values[int(rng.integers(len(values)))]
    return drawn


def _run_seed(seed: int, repeat: int) -> int:
    return int(np.random.SeedSequence([seed, repeat]).generate_state(1)[0])


def _check(argument: str, values: Any, *, drawn: bool) -> None:
    if drawn and isinstance(values, Uniform):
        return
    if isinstance(values, str) or not isinstance(values, Sequence) or not len(values):
        kinds = "a Uniform or a list of values" if drawn else "a list of values"
        raise ArgumentError(argument, values, f"give {kinds}")
    try:
        json.dumps(list(values), allow_nan=False)
    except (TypeError, ValueError):
        remedy = "give plain values: numbers, words, or lists of them"
        raise ArgumentError(argument, values, remedy) from None
