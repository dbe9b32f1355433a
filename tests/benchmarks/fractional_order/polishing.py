"""A check of the searches: go on from a design, for the error alone, within its budget.

A search for three objectives at once spreads its trials. If it left one order further from its
best than the other, the comparison would be one of luck. From the design of a search for a budget
of torque variation the Nelder-Mead simplex goes on with as many trials for either order: inside the
search's own spans, or inside wider ones, in case an order wants to leave them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import minimize

from fotsmc_pin.evaluation.stress.baseline import STEEPNESS
from fotsmc_pin.evaluation.tuning.minimize import trying_anything
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS
from tests.benchmarks.fractional_order.held_out import SETTINGS, chosen
from tests.benchmarks.fractional_order.runs import rounded, run
from tests.benchmarks.fractional_order.searching import between
from tests.benchmarks.fractional_order.settings import held_out_setting, search_setting
from tests.benchmarks.fractional_order.store import Trial

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fotsmc_pin.evaluation.tuning import Span
    from fotsmc_pin.types import Array
    from tests.benchmarks.fractional_order.runs import Outcome
    from tests.benchmarks.fractional_order.store import Search, Store

POLISHED = ("variation 0.5", "variation 1")
"""Budgets whose designs are polished."""
MORE_TRIALS = 100
FIRST_STEP = 0.08
"""Edge of the first simplex, as a share of each gain's span."""


WIDER = 10.0
"""Factor by which wider spans reach beyond those of the search, where these are logarithmic."""


def polished_search(search: Search, budget: str, *, wide: bool) -> Search:
    """Return the name under which the further trials are kept."""
    where = ", wider" if wide else ""
    return search._replace(configuration=f"{search.configuration} from {budget}{where}")


def space_of(configuration: str, *, wide: bool) -> dict[str, Span]:
    """Return where the further trials look for each gain."""
    space = dict(CONFIGURATIONS[configuration].space)
    if wide:
        for name, span in space.items():
            if span.logarithmic:
                space[name] = replace(span, low=span.low / WIDER, high=span.high * WIDER)
    return space


def polish(
    search: Search,
    trials: Sequence[Trial],
    default: Outcome,
    store: Store,
    *,
    wide: bool = False,
    more: int = MORE_TRIALS,
) -> None:
    """Do what is missing: further trials from the design of each budget, and held-out runs."""
    numbers = chosen(trials, default)
    for budget in POLISHED:
        if budget in numbers:
            limit = float(budget.split()[1]) * default.variation
            kept, start = polished_search(search, budget, wide=wide), trials[numbers[budget]]
            space = space_of(search.configuration, wide=wide)
            done = _descend(kept, search.configuration, space, start, limit, store, more)
            _judge(kept, search.configuration, best_within(done, limit), done, store)


def best_within(trials: Sequence[Trial], limit: float) -> int:
    """Return the number of the trial with the smallest error within a torque variation."""
    return min(
        (trial.outcome.error, number)
        for number, trial in enumerate(trials)
        if trial.outcome.variation <= limit
    )[1]


def _descend(
    kept: Search,
    name: str,
    space: Mapping[str, Span],
    start: Trial,
    limit: float,
    store: Store,
    more: int,
) -> list[Trial]:
    known = store.of(kept).trials[kept]
    configuration = CONFIGURATIONS[name]
    setting = search_setting(kept.problem, kept.seed)
    done: list[Trial] = []

    def cost(x: Array) -> float:
        number = len(done)
        gains = {
            name: rounded(between(span, float(share)))
            for (name, span), share in zip(space.items(), np.clip(x, 0.0, 1.0), strict=True)
        }
        if number == 0:
            gains = dict(start.gains)
        if number < len(known):
            trial = known[number]
            if dict(trial.gains) != gains:
                raise RuntimeError(f"{kept.file}: trial {number} was another; take the file away")
        else:
            law = configuration.controller(setting.nominal, gains, learning=kept.learning)
            trial = Trial(gains, run(setting, law))
            store.add_trial(kept, number, trial)
        done.append(trial)
        excess = max(1.0, trial.outcome.variation / limit)
        return math.log(trial.outcome.error) + STEEPNESS * min(math.log(excess), 10.0)

    x = np.array([share_of(span, start.gains[name]) for name, span in space.items()])
    steps = np.where(x > 0.5, -FIRST_STEP, FIRST_STEP)
    options: dict[str, Any] = {
        "maxfev": more,
        "adaptive": True,
        "initial_simplex": np.vstack([x, x + np.diag(steps)]),
        "xatol": 0.0,
        "fatol": 0.0,
    }
    with trying_anything():
        minimize(cost, x, method="Nelder-Mead", options=options)
    return done


def share_of(span: Span, value: float) -> float:
    """Return at which share of a span a number lies; `between` backwards."""
    low, high, at = span.low, span.high, value
    if span.logarithmic:
        low, high, at = math.log(low), math.log(high), math.log(at)
    return (at - low) / (high - low)


def _judge(kept: Search, name: str, number: int, trials: Sequence[Trial], store: Store) -> None:
    known, gains = store.of(kept).held_out[kept], trials[number].gains
    for k in range(SETTINGS):
        if (number, k) not in known:
            setting = held_out_setting(kept.problem, k)
            with trying_anything():
                law = CONFIGURATIONS[name].controller(
                    setting.nominal, gains, learning=kept.learning
                )
                store.add_held_out(kept, number, k, run(setting, law))
