"""The stress suite: scenarios that are hard on any arm, random ones, and an ablation."""

from fotsmc_pin.evaluation.stress.ablation import VARIANTS, ablate
from fotsmc_pin.evaluation.stress.baseline import best_pid
from fotsmc_pin.evaluation.stress.case import Case
from fotsmc_pin.evaluation.stress.cases import SCENARIOS, chosen_cases, stress_scenario
from fotsmc_pin.evaluation.stress.courses import Course, Rest
from fotsmc_pin.evaluation.stress.judging import StressRow, judge
from fotsmc_pin.evaluation.stress.random_scenarios import (
    SeededRow,
    random_scenario,
    run_random_scenarios,
)
from fotsmc_pin.evaluation.stress.scenario import Scenario
from fotsmc_pin.evaluation.stress.suite import stress
from fotsmc_pin.evaluation.stress.table import markdown

__all__ = [
    "stress",
    "stress_scenario",
    "SCENARIOS",
    "Case",
    "chosen_cases",
    "Course",
    "Rest",
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
