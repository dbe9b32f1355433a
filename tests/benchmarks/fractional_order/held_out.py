"""Which trials of a search are judged, and their runs in the held-out settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.evaluation.tuning.minimize import trying_anything
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS
from tests.benchmarks.fractional_order.runs import run
from tests.benchmarks.fractional_order.settings import LONG, held_out_setting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tests.benchmarks.fractional_order.runs import Outcome
    from tests.benchmarks.fractional_order.store import Search, Store, Trial

SETTINGS = 8
VARIATIONS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Budgets of torque variation, over that of the law with its defaults in the same setting."""
PEAKS = (0.6, 0.8, 1.05, 1.5)
"""Budgets of peak torque, over that of the law with its defaults."""
MOST_VARIATION = 2.0
"""Budget of torque variation that holds beside every budget of peak torque: beyond, drives hum."""
LONG_BUDGET = "variation 1"
"""Budget whose trial is run for longer too, in the sinusoids."""
CARRIED = ("variation 0.5", "variation 1")
"""Budgets whose trials of a search without learning are run with learning too."""
DEFAULT = 0
"""Number of the trial with the law's defaults."""


def chosen(trials: Sequence[Trial], default: Outcome) -> dict[str, int]:
    """Return the number of the trial that is judged for each budget that one meets.

    That is the one with the smallest error in the search setting of those within the budget.
    Budgets are named "variation 0.5", "peak 0.8".

    Args:
        trials: of a search.
        default: the law with its defaults in the same setting, by which budgets are measured.
    """
    found = {}
    for budget in VARIATIONS:
        number = _best(trials, budget * default.variation, float("inf"))
        if number is not None:
            found[f"variation {budget:g}"] = number
    for budget in PEAKS:
        number = _best(trials, MOST_VARIATION * default.variation, budget * default.peak)
        if number is not None:
            found[f"peak {budget:g}"] = number
    return found


def judge_search(
    search: Search,
    trials: Sequence[Trial],
    default: Outcome,
    store: Store,
    *,
    long: bool = False,
) -> None:
    """Run what is missing of a search's chosen trials, and its defaults, in held-out settings.

    Args:
        search: the search.
        trials: of it.
        default: the law with its defaults in the setting of the search.
        store: where the runs are kept.
        long: run the longer settings in place of the others.
    """
    known = store.of(search).held_out[search]
    configuration = CONFIGURATIONS[search.configuration]
    numbers = chosen(trials, default)
    if long:
        judged = {numbers[LONG_BUDGET]} if LONG_BUDGET in numbers else set()
        settings = [LONG + k for k in range(0, SETTINGS, 2)]
    else:
        judged, settings = {*numbers.values()}, [*range(SETTINGS)]
    for k in settings:
        missing = [number for number in sorted({DEFAULT, *judged}) if (number, k) not in known]
        if not missing:
            continue
        setting = held_out_setting(search.problem, k)
        with trying_anything():
            for number in missing:
                gains = trials[number].gains
                law = configuration.controller(setting.nominal, gains, learning=search.learning)
                store.add_held_out(search, number, k, run(setting, law))


def carried(search: Search) -> Search:
    """Return the name under which designs of a search without learning are kept with learning."""
    return search._replace(configuration=f"{search.configuration}, found without", learning=True)


def carry(search: Search, trials: Sequence[Trial], default: Outcome, store: Store) -> None:
    """Run what is missing of designs that were found without learning, with learning."""
    kept, numbers = carried(search), chosen(trials, default)
    known = store.of(kept).held_out[kept]
    judged = sorted({numbers[budget] for budget in CARRIED if budget in numbers})
    for k in range(SETTINGS):
        missing = [number for number in judged if (number, k) not in known]
        if missing:
            setting = held_out_setting(search.problem, k)
            configuration = CONFIGURATIONS[search.configuration]
            with trying_anything():
                for number in missing:
                    gains = trials[number].gains
                    law = configuration.controller(setting.nominal, gains, learning=True)
                    store.add_held_out(kept, number, k, run(setting, law))


def _best(trials: Sequence[Trial], variation: float, peak: float) -> int | None:
    within = [
        (trial.outcome.error, number)
        for number, trial in enumerate(trials)
        if not trial.outcome.lost
        and trial.outcome.variation <= variation
        and trial.outcome.peak <= peak
    ]
    return min(within)[1] if within else None
