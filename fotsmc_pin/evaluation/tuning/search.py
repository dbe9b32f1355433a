"""`search_gains`: the gains of a law that make a cost small, found by Optuna."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from fotsmc_pin.evaluation.tuning.minimize import minimize
from fotsmc_pin.evaluation.tuning.space import search_space

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

    The search is `minimize` over `search_space(law, start)`: its first trial is `start`, as far as
    that lies inside the space, and the same seed gives the same outcome.

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
    fixed = dict(start or {})
    space = {name: span for name, span in search_space(law, fixed).items() if name not in hold}
    defaults: dict[str, Any] = {field.name: field.default for field in fields(law.Gains)} | fixed
    first = {name: min(max(defaults[name], span.low), span.high) for name, span in space.items()}
    found = minimize(
        lambda drawn: cost(fixed | drawn), space, start=first, trials=trials, seed=seed
    )
    best = fixed | found
    return Tuned(gains=best, cost=cost(best), trials=trials, seed=seed)
