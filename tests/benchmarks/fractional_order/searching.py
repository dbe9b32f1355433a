"""The search: NSGA-II for small tail error, small torque variation and small peak torque at once.

All three objectives come from one run, so that the fronts of error against torque variation and of
error against peak torque are those of the same trials. The first generation is the law's defaults
and a scrambled Sobol sequence, in which the laws on the sliding surface have the gains that they
share in common.
"""

from __future__ import annotations

import math
import warnings
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import qmc

from fotsmc_pin.evaluation.tuning.minimize import require_optuna, trying_anything
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS, OWN, SHARED
from tests.benchmarks.fractional_order.runs import Outcome, rounded, run
from tests.benchmarks.fractional_order.settings import search_setting
from tests.benchmarks.fractional_order.store import Trial

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.evaluation.tuning import Span
    from tests.benchmarks.fractional_order.store import Search, Store

TRIALS, POPULATION = 300, 25
PENALTY = (1e3, 1e9, 1e9)
"""Objectives of a run that was lost."""


def finish(search: Search, store: Store, trials: int = TRIALS) -> list[Trial]:
    """Do what is missing of a search, and return all its trials.

    The search is a function of its seed: what the store holds is told to the sampler again, which
    then goes on as if it had never stopped.
    """
    known = store.of(search).trials[search]
    if len(known) >= trials:
        return known[:trials]
    optuna = require_optuna()
    configuration = CONFIGURATIONS[search.configuration]
    setting = search_setting(search.problem, search.seed)
    with trying_anything(), warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        sampler = optuna.samplers.NSGAIISampler(
            population_size=POPULATION,
            crossover=optuna.samplers.nsgaii.SBXCrossover(),
            seed=sampler_seed(search),
        )
        study = optuna.create_study(sampler=sampler, directions=["minimize"] * 3)
        for first in first_generation(search.configuration, sampler_seed(search)):
            study.enqueue_trial(first)
        done = []
        for number in range(trials):
            asked = study.ask(_distributions(optuna, configuration.space))
            gains = {name: rounded(value) for name, value in asked.params.items()}
            if number < len(known):
                trial = known[number]
                _demand_same(search, number, trial.gains, gains)
            else:
                trial = Trial(gains, _try(configuration, setting, gains, search.learning))
                store.add_trial(search, number, trial)
            study.tell(asked, _objectives(trial.outcome))
            done.append(trial)
    return done


def sampler_seed(search: Search) -> int:
    """Return what seeds the sampler: the same for both orders, another for each arm.

    Of the first seed it is the same for every arm, as that search was run so.
    """
    if search.seed == 1:
        return 1
    return zlib.crc32(f"{search.problem} {search.seed}".encode())


def first_generation(configuration: str, seed: int) -> list[dict[str, float]]:
    """Return the gains of the first trials."""
    chosen = CONFIGURATIONS[configuration]
    points = qmc.Sobol(len(SHARED | OWN), seed=seed).random(32)[: POPULATION - 1]
    drawn = [
        {
            name: between(span, share)
            for (name, span), share in zip(chosen.space.items(), row, strict=False)
        }
        for row in points.tolist()
    ]
    return [dict(chosen.start), *drawn]


def between(span: Span, share: float) -> float:
    """Return the number that lies at a share of a span, 0 at its lower and 1 at its upper end."""
    if span.logarithmic:
        return float(math.exp(np.interp(share, (0.0, 1.0), np.log((span.low, span.high)))))
    return span.low + share * (span.high - span.low)


def _distributions(optuna: Any, space: Mapping[str, Span]) -> dict[str, Any]:
    made = optuna.distributions.FloatDistribution
    return {name: made(span.low, span.high, log=span.logarithmic) for name, span in space.items()}


def _try(configuration: Any, setting: Any, gains: Mapping[str, float], learning: bool) -> Outcome:
    return run(setting, configuration.controller(setting.nominal, gains, learning=learning))


def _objectives(outcome: Outcome) -> tuple[float, float, float]:
    return PENALTY if outcome.lost else (outcome.error, outcome.variation, outcome.peak)


def _demand_same(
    search: Search, number: int, stored: Mapping[str, float], asked: Mapping[str, float]
) -> None:
    if dict(stored) != dict(asked):
        raise RuntimeError(
            f"{search.file}: trial {number} is stored with {dict(stored)}, but the search now asks "
            f"for {dict(asked)}; another version of Optuna or other spans made it. Name another "
            "folder, or take these away."
        )
