"""From stored runs to paired differences: two configurations, one question, the same settings."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tests.benchmarks.fractional_order.held_out import (
    DEFAULT,
    PEAKS,
    SETTINGS,
    VARIATIONS,
    carried,
    chosen,
)
from tests.benchmarks.fractional_order.judging import (
    Interval,
    hypervolume_difference,
    pooled_interval,
)
from tests.benchmarks.fractional_order.polishing import polished_search
from tests.benchmarks.fractional_order.settings import PROBLEMS
from tests.benchmarks.fractional_order.store import Search

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.types import Array
    from tests.benchmarks.fractional_order.store import Results

ERROR, VARIATION, PEAK = range(3)
"""Columns of an outcome."""
BUDGETS = {
    "variation": tuple(f"variation {budget:g}" for budget in VARIATIONS),
    "peak": tuple(f"peak {budget:g}" for budget in PEAKS),
}
"""Budgets of each of the two questions, by the names that `held_out.chosen` gives them."""
THIRD = {"variation": VARIATION, "peak": PEAK}
"""What stands on the other axis of each question's front."""


class Pair(NamedTuple):
    """Two configurations of a problem under the same budgets.

    Attributes:
        by_seed: for each seed, ln of the ratio of their errors in each held-out setting, mean over
            budgets (settings,).
        other: the same of their torque variation, or of their peak torque, by the question.
        budgets: names of the budgets that both can meet with some seed.
        lost: held-out runs that each of both lost, and how many there were.
    """

    by_seed: tuple[Array, ...]
    other: Array
    budgets: tuple[str, ...]
    lost: tuple[int, int, int]

    @property
    def ratio(self) -> Interval:
        """Geometric mean of the ratio of errors, with its interval.

        Of one search it holds for other settings; of several for other searches as well.
        """
        return pooled_interval(self.by_seed).mapped(np.exp)

    @property
    def differences(self) -> Array:
        """The mean of all seeds (settings,)."""
        return np.mean(self.by_seed, axis=0)


def seeds_of(
    results: Results,
    problem: str,
    learning: bool,
    wanted: Sequence[str] = ("integer", "free", "pid"),
) -> list[int]:
    """Return the seeds with which all wanted configurations were searched and judged."""
    every = {search.seed for search in results.trials}
    return sorted(
        seed
        for seed in every
        if all(
            _judged(results, Search(problem, configuration, learning, seed))
            for configuration in wanted
        )
    )


def done_problems(results: Results, learning: bool) -> list[str]:
    """Return the problems that were finished with some seed."""
    return [problem for problem in PROBLEMS if seeds_of(results, problem, learning)]


def designs(results: Results, search: Search) -> dict[str, int]:
    """Return the number of the trial that stands for each budget."""
    default = results.trials[search._replace(configuration="free")][DEFAULT].outcome
    return chosen(results.trials[search], default)


def held_out(
    results: Results, search: Search, trial: int, settings: Sequence[int] = range(SETTINGS)
) -> Array:
    """Return error, torque variation and peak torque of a trial in each setting (settings, 3).

    A run that was lost has the error of a lost one, and no torques: nan.
    """
    found = results.held_out[search]
    rows = np.array([found[trial, k][:3] for k in settings])
    return np.where(np.isfinite(rows), rows, np.nan)


def compare(
    results: Results,
    problem: str,
    learning: bool,
    ours: str,
    others: str,
    budgets: Sequence[str],
    *,
    seeds: Sequence[int] | None = None,
    settings: Sequence[int] = range(SETTINGS),
) -> Pair | None:
    """Return how two configurations compare under budgets; None where both never meet one."""
    column = THIRD[budgets[0].split()[0]]
    by_seed, third, used, lost = [], [], [], [0, 0, 0]
    for seed in seeds or seeds_of(results, problem, learning, (ours, others)):
        pair = [Search(problem, name, learning, seed) for name in (ours, others)]
        found = [designs(results, search) for search in pair]
        errors = []
        for budget in budgets:
            if not all(budget in numbers for numbers in found):
                continue
            a, b = (
                held_out(results, search, numbers[budget], settings)
                for search, numbers in zip(pair, found, strict=True)
            )
            errors.append(np.log(a[:, ERROR] / b[:, ERROR]))
            third.append(np.log(a[:, column] / b[:, column]))
            used.append(budget)
            for side, rows in enumerate((a, b)):
                lost[side] += int(np.isnan(rows[:, column]).sum())
            lost[2] += len(a)
        if errors:
            by_seed.append(np.mean(errors, axis=0))
    if not by_seed:
        return None
    return Pair(
        tuple(by_seed),
        _mean_of_known(np.array(third)),
        tuple(budget for budget in budgets if budget in used),
        (lost[0], lost[1], lost[2]),
    )


def compare_fronts(
    results: Results, problem: str, learning: bool, ours: str, others: str, question: str
) -> Interval | None:
    """Return by how much our held-out front dominates more, in square decades, mean over seeds.

    Runs that were lost count with the largest torque variation, or peak torque, of all.
    """
    column, found = THIRD[question], []
    for seed in seeds_of(results, problem, learning, (ours, others)):
        sets = []
        for name in (ours, others):
            search = Search(problem, name, learning, seed)
            numbers = designs(results, search)
            rows = [
                held_out(results, search, numbers[budget])[:, (ERROR, column)]
                for budget in BUDGETS[question]
                if budget in numbers
            ]
            sets.append(np.array(rows))
        if all(len(points) for points in sets):
            worst = np.nanmax(np.concatenate(sets)[..., 1])
            points = [np.log10(np.where(np.isnan(x), worst, x)) for x in sets]
            found.append(hypervolume_difference(points[0], points[1]))
    return Interval(*np.mean(found, axis=0)) if found else None


def compare_defaults(results: Results, problem: str, learning: bool) -> Array | None:
    """Return ln of the ratios of order 0.3 over order 0 with all other gains at their defaults.

    Of error, torque variation and peak torque in each held-out setting (settings, 3).
    """
    seeds = seeds_of(results, problem, learning)
    if not seeds:
        return None
    a, b = (
        held_out(results, Search(problem, name, learning, seeds[0]), DEFAULT)
        for name in ("free", "integer")
    )
    return np.asarray(np.log(a / b))


def compare_polished(
    results: Results, search: Search, ours: str, others: str, budget: str, *, wide: bool
) -> tuple[Pair, Pair] | None:
    """Return how two configurations compare at a budget, before and after further trials."""
    rows = []
    for name in (ours, others):
        kept = polished_search(search._replace(configuration=name), budget, wide=wide)
        numbers = {number for number, _ in results.held_out.get(kept, {})}
        if len(numbers) != 1 or len(results.held_out[kept]) < SETTINGS:
            return None
        rows.append(held_out(results, kept, numbers.pop()))
    problem, learning, seed = search.problem, search.learning, search.seed
    before = compare(results, problem, learning, ours, others, [budget], seeds=[seed])
    if before is None:
        return None
    a, b = rows
    difference = np.log(a / b)
    lost = (int(np.isnan(a[:, 1]).sum()), int(np.isnan(b[:, 1]).sum()), SETTINGS)
    after = Pair((difference[:, ERROR],), difference[:, VARIATION], (budget,), lost)
    return before, after


def compare_carried(
    results: Results, problem: str, ours: str, others: str, budget: str
) -> Pair | None:
    """Return how two configurations compare with learning, by designs found without it."""
    rows = []
    for name in (ours, others):
        search = Search(problem, name, False, 1)
        kept, number = carried(search), designs(results, search).get(budget)
        if number is None or (number, SETTINGS - 1) not in results.held_out.get(kept, {}):
            return None
        rows.append(held_out(results, kept, number))
    a, b = rows
    difference = np.log(a / b)
    lost = (int(np.isnan(a[:, 1]).sum()), int(np.isnan(b[:, 1]).sum()), SETTINGS)
    return Pair((np.log(a[:, ERROR] / b[:, ERROR]),), difference[:, VARIATION], (budget,), lost)


def _judged(results: Results, search: Search) -> bool:
    if not results.trials.get(search) or search not in results.held_out:
        return False
    if not results.trials.get(search._replace(configuration="free")):
        return False
    numbers = {DEFAULT, *designs(results, search).values()}
    return all((n, k) in results.held_out[search] for n in numbers for k in range(SETTINGS))


def _mean_of_known(rows: Array) -> Array:
    """Return the mean over the first axis of what is not nan; nan where nothing is known."""
    known = np.isfinite(rows)
    count = known.sum(axis=0)
    total = np.where(known, rows, 0.0).sum(axis=0)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))
