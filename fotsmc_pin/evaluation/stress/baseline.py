"""`best_pid`: the best computed-torque PID that a search finds on an arm's own scenario."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.control import ComputedTorque
from fotsmc_pin.evaluation.stress.judging import StressRow, run_row
from fotsmc_pin.evaluation.stress.scenario import DURATION
from fotsmc_pin.evaluation.tuning import Span, minimize
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from fotsmc_pin.evaluation.stress.scenario import Scenario
    from fotsmc_pin.progress import Progress

TRIALS = 200
SEARCH_SPACE = {
    "kp": Span(low=10.0, high=1e5, logarithmic=True),
    "kd": Span(low=3.0, high=1e3, logarithmic=True),
    "ki": Span(low=1.0, high=1e7, logarithmic=True),
}
"""Search space of the PID's gains: two and a half to seven decades each."""
STEEPNESS = 4
"""Exponent with which torque variation beyond its bound, as a ratio, multiplies the cost."""
PENALTY = 10.0
"""Cost of a run that diverged [rad]."""


def best_pid(
    scenario: Scenario,
    *,
    trials: int = TRIALS,
    seed: int = 0,
    duration: float = DURATION,
    largest_variation: float = math.inf,
    progress: Progress = False,
) -> tuple[StressRow, dict[str, float]]:
    """Search the PID gains with the smallest tail RMS error on the scenario itself.

    The PID is tuned on the very run that it is judged by, including the noise; its competitor is
    not.

    Args:
        scenario: the run that the PID is tuned on and judged by.
        trials: how many sets of gains are tried, the law's own PID preset first.
        seed: of the search.
        duration: simulated time of each run [s].
        largest_variation: torque variation that the PID may have [N·m/s]; without a bound the
            search ends at the edge of stability, where the drives hum with the noise.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        The row of the best run, and its gains.

    Raises:
        MissingDependencyError: Optuna is not installed.
    """

    def judged(gains: dict[str, Any]) -> StressRow:
        return run_row(
            scenario, ComputedTorque(scenario.arm, scenario.dt, **gains), "best PID", duration
        )

    def cost(gains: dict[str, float]) -> float:
        row = judged(gains)
        excess = max(1.0, row.torque_variation / largest_variation)
        return min(row.tail_rms_error * excess**STEEPNESS, PENALTY)

    start = {name: float(value) for name, value in ComputedTorque.presets["pid"].items()}
    with reporting(progress, f"best PID, {scenario.arm.name}") as report:
        best = minimize(cost, SEARCH_SPACE, start=start, trials=trials, seed=seed, progress=report)
    return judged(best), best
