"""`tune`: the front of gains between small errors and quiet torques, kept in a file as it grows."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.tuning.minimize import require_optuna, suggested, trying_anything
from fotsmc_pin.evaluation.tuning.space import search_space
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping

    from fotsmc_pin.analysis import Summary
    from fotsmc_pin.control import Controller
    from fotsmc_pin.progress import Progress

OBJECTIVES = ("tail_rms_error", "max_tail_error", "rms_error", "settling_time", "iae", "itae")
"""Metrics of a `Summary` that may be made small beside the torque variation."""
FAILED = 1e6
"""Both objectives of a run that diverged or broke its torque limit."""


@dataclass(frozen=True, kw_only=True)
class FrontPoint:
    """A set of gains that no other beats in both error and torque variation.

    Attributes:
        gains: what differs from the law's defaults, by name.
        error: the chosen metric of error.
        torque_variation: in the last half of the run [N·m/s].
        trial: number of the trial.
    """

    gains: dict[str, float]
    error: float
    torque_variation: float
    trial: int

    def as_dict(self) -> dict[str, Any]:
        """Return the point as plain data."""
        return asdict(self)


def tune(
    law: type[Controller],
    run: Callable[[dict[str, Any]], Summary | None],
    path: str | os.PathLike[str],
    *,
    start: Mapping[str, Any],
    trials: int = 100,
    objective: str = "tail_rms_error",
    largest_torque: float | None = None,
    seed: int = 0,
    about: Mapping[str, Any] | None = None,
    progress: Progress = False,
) -> list[FrontPoint]:
    """Search gains for small error and small torque variation at once; go on where it was left.

    Every finished trial is in the file `path` at once, so that a killed search loses the trial that
    was under way and no other. Calling again with the same file does what is missing to `trials`.

    Args:
        law: the control law.
        run: gains to the summary of their run, or None where it diverged.
        path: Optuna's journal; made if it is not there.
        start: gains of the first trial, around which the search is laid (`search_space`).
        trials: how many there are to be in the file at the end.
        objective: metric of error; one of `OBJECTIVES`.
        largest_torque: peak torque that a run may have [N·m]; None for no bound beyond the arm's.
        seed: of the search.
        about: whatever else the outcome of `run` depends on (the arm, the scenario), as plain data
            by name. It is kept in the file, and a search about something else is refused.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        The front, smallest error first.

    Raises:
        ArgumentError: an unknown objective, a bad number, or a file of another search: the message
            says what differs.
        MissingDependencyError: Optuna is not installed.
    """
    optuna = require_optuna()
    checks.choice("objective", objective, OBJECTIVES)
    trials = checks.count("trials", trials)
    space = search_space(law, start)
    known = {
        "law": law.__name__,
        "objective": objective,
        "largest_torque": largest_torque,
        "seed": seed,
        "start": {name: _plain(value) for name, value in start.items()},
        **(about or {}),
    }
    search = _open_search(optuna, path, seed, known)
    if not search.trials:
        search.enqueue_trial(
            {name: min(max(start[name], span.low), span.high) for name, span in space.items()}
        )

    def cost(trial: Any) -> tuple[float, float]:
        summary = run(suggested(trial, space))
        if summary is None:
            return FAILED, FAILED
        if largest_torque is not None and summary.peak_torque > largest_torque:
            return FAILED, FAILED
        return min(getattr(summary, objective), FAILED), summary.tail_torque_variation

    with reporting(progress, f"tuning {law.__name__}") as report, trying_anything():
        while (done := len(_finished(optuna, search))) < trials:
            # Not `optimize`, out of which an interrupt comes as another error while it writes.
            trial = search.ask()
            search.tell(trial, cost(trial))
            report((done + 1) / trials)
    return sorted(
        (
            FrontPoint(
                gains=trial.params,
                error=trial.values[0],
                torque_variation=trial.values[1],
                trial=trial.number,
            )
            for trial in search.best_trials
            if trial.values[0] < FAILED
        ),
        key=lambda point: point.error,
    )


def _open_search(
    optuna: Any, path: str | os.PathLike[str], seed: int, about: dict[str, Any]
) -> Any:
    """Return the search in the file, made if it is new; another search's file is refused."""
    backend = optuna.storages.journal.JournalFileBackend(str(path))
    search = optuna.create_study(
        storage=optuna.storages.JournalStorage(backend),
        study_name="tune",
        sampler=optuna.samplers.TPESampler(seed=seed),
        directions=["minimize", "minimize"],
        load_if_exists=True,
    )
    before = search.user_attrs.get("about")
    if before is None:
        search.set_user_attr("about", about)
    elif before != about:
        raise ArgumentError(
            "path",
            str(path),
            f"holds another search: {'; '.join(_differences(before, about))}. Name another file, "
            "or ask for the same",
        )
    return search


def _differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Return in words where two searches differ."""
    names = [name for name in dict.fromkeys([*now, *before]) if before.get(name) != now.get(name)]
    words = [
        f"its {name} is {before.get(name, 'not known')}, not {now.get(name, 'given')}"
        for name in names
        if name != "start"
    ]
    if "start" in names:
        old, new = before.get("start", {}), now.get("start", {})
        differing = [gain for gain in new if old.get(gain) != new[gain]]
        words.append(f"it starts from another {', '.join(differing) or 'set of gains'}")
    return words


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def _finished(optuna: Any, search: Any) -> list[Any]:
    finished: list[Any] = search.get_trials(
        deepcopy=False, states=(optuna.trial.TrialState.COMPLETE,)
    )
    return finished
