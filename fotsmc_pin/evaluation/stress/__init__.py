"""The stress suite: a scenario that is hard on any arm, random scenarios, and an ablation."""

from fotsmc_pin.evaluation.stress.ablation import VARIANTS, ablate
from fotsmc_pin.evaluation.stress.baseline import best_pid
from fotsmc_pin.evaluation.stress.random_scenarios import (
    SeededRow,
    random_scenario,
    run_random_scenarios,
)
from fotsmc_pin.evaluation.stress.scenario import Scenario, stress_scenario
from fotsmc_pin.evaluation.stress.suite import stress
from fotsmc_pin.evaluation.stress.table import StressRow, judge, markdown

__all__ = [
    "stress",
    "stress_scenario",
    "Scenario",
    "StressRow",
    "markdown",
    "best_pid",
    "judge",
    "ablate",
    "VARIANTS",
    "SeededRow",
    "random_scenario",
    "run_random_scenarios",
]
