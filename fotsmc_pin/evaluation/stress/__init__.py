"""The stress suite: a scenario that is hard on any arm, random draws, and an ablation."""

from fotsmc_pin.evaluation.stress.ablation import VARIANTS, ablate
from fotsmc_pin.evaluation.stress.baseline import best_pid
from fotsmc_pin.evaluation.stress.draws import Draw, draw_case, run_draws
from fotsmc_pin.evaluation.stress.scenario import Scenario, scenario
from fotsmc_pin.evaluation.stress.suite import stress
from fotsmc_pin.evaluation.stress.table import StressRow, judge, markdown

__all__ = [
    "stress",
    "scenario",
    "Scenario",
    "StressRow",
    "markdown",
    "best_pid",
    "judge",
    "ablate",
    "VARIANTS",
    "Draw",
    "draw_case",
    "run_draws",
]
