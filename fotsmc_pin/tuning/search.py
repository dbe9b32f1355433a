"""`search_gains`: the gains of a law that make a cost small, found by Optuna."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from fotsmc_pin import checks
from fotsmc_pin.errors import MissingDependencyError
from fotsmc_pin.tuning.space import search_space

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

    from fotsmc_pin.control import Controller


@dataclass(frozen=True, kw_only=True)
class Tuned:
    """Outcome of a search.

    Attributes:
        gains: the best gains that were found; what they leave out keeps its default.
        cost: their cost.
        trials: how many sets of gains were tried.
        seed: of the search.
    """

    gains: dict[str, Any]
    cost: float
    trials: int
    seed: int


def search_gains(
    law: type[Controller],
    cost: Callable[[dict[str, Any]], float],
    *,
    start: Mapping[str, Any] | None = None,
    hold: Collection[str] = (),
    trials: int = 200,
    seed: int = 0,
) -> Tuned:
    """Search the gains of `law` that make `cost` small, from `start` on.

    The search is Optuna's tree-structured Parzen estimator over `search_space(law, start)`. The
    first trial is `start` itself, so that the outcome is never worse. The same seed gives the
    same outcome.

    Args:
        law: the control law.
        cost: what is to be small; a large number where a run fails or breaks a constraint.
        start: gains that differ from the defaults; options among them stay as they are.
        hold: gains that stay at their start.
        trials: how many sets of gains are tried, the start included.
        seed: of the search.

    Raises:
        MissingDependencyError: Optuna is not installed.
    """
    try:
        import optuna
    except ImportError as error:
        raise MissingDependencyError(
            "the search of gains needs Optuna: pip install 'fotsmc_pin[tune]'"
        ) from error
    trials = checks.count("trials", trials)
    fixed = dict(start or {})
    space = {name: span for name, span in search_space(law, fixed).items() if name not in hold}
    defaults: dict[str, Any] = {field.name: field.default for field in fields(law.Gains)}

    def objective(trial: Any) -> float:
        drawn = {
            name: trial.suggest_float(name, span.low, span.high, log=span.logarithmic)
            for name, span in space.items()
        }
        return cost(fixed | drawn)

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    first = {name: (defaults | fixed)[name] for name in space}
    study.enqueue_trial(
        {name: min(max(value, space[name].low), space[name].high) for name, value in first.items()}
    )
    study.optimize(objective, n_trials=trials)
    return Tuned(gains=fixed | study.best_params, cost=study.best_value, trials=trials, seed=seed)
