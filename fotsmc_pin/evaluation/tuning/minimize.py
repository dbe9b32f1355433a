"""`minimize`: the numbers inside given spans that make a cost small, found by Optuna."""

from __future__ import annotations

import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from fotsmc_pin import checks
from fotsmc_pin.control import TickWarning
from fotsmc_pin.errors import MissingDependencyError
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from types import ModuleType

    from fotsmc_pin.evaluation.tuning.space import Span
    from fotsmc_pin.progress import Progress


def minimize(
    cost: Callable[[dict[str, float]], float],
    space: Mapping[str, Span],
    *,
    start: Mapping[str, float],
    trials: int = 200,
    seed: int = 0,
    progress: Progress = False,
) -> dict[str, float]:
    """Search `space` for a small `cost` by Optuna's tree-structured Parzen estimator.

    The first trial is `start`, so that the outcome is never worse. The same seed gives the same
    outcome.

    Args:
        cost: of one number per name of `space`.
        space: where each number is looked for.
        start: the first trial.
        trials: how many are made.
        seed: of the search.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Raises:
        MissingDependencyError: Optuna is not installed.
    """
    optuna = require_optuna()
    trials = checks.count("trials", trials)
    search = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    search.enqueue_trial(dict(start))

    with reporting(progress, "searching") as report, trying_anything():
        search.optimize(
            lambda trial: cost(suggested(trial, space)),
            n_trials=trials,
            callbacks=[lambda _, trial: report((trial.number + 1) / trials)],
        )
    best: dict[str, float] = search.best_params
    return best


@contextmanager
def trying_anything() -> Iterator[None]:
    """Let the block make controllers whose gains nobody would choose, without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TickWarning)
        yield


def suggested(trial: Any, space: Mapping[str, Span]) -> dict[str, float]:
    """Return what a trial of Optuna draws from `space`."""
    return {
        name: trial.suggest_float(name, span.low, span.high, log=span.logarithmic)
        for name, span in space.items()
    }


def require_optuna() -> ModuleType:
    """Return the module `optuna`, told to speak of errors only.

    Raises:
        MissingDependencyError: it is not installed.
    """
    try:
        import optuna
    except ImportError as error:
        raise MissingDependencyError(
            "the search of gains needs Optuna: pip install optuna"
        ) from error
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    module: ModuleType = optuna
    return module
