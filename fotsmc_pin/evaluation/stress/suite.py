"""`stress`: controllers times arms times scenarios, one row for each run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import joblib

from fotsmc_pin import checks
from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import CONTROLLERS, Controller, TaskSpace, warn_of_gravity
from fotsmc_pin.evaluation.stress.cases import chosen_cases
from fotsmc_pin.evaluation.stress.judging import StressRow, run_row
from fotsmc_pin.evaluation.stress.springs import fitted_to_springs, with_learning
from fotsmc_pin.learning.described import LABEL
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.case import Case
    from fotsmc_pin.progress import Progress

    Maker: TypeAlias = Callable[[Arm, float], Controller]

Result = TypeVar("Result")

PREFERRED_PRESETS = ("practical", "pid", "boundary_layer")
"""Presets for use on an arm, where a law has one; the first preset of a law is its printed form."""
DEFAULT_CASE = "sine raw"


def stress(
    arms: Iterable[Arm | str],
    controllers: Iterable[str] | Mapping[str, Maker] | None = None,
    *,
    scenarios: str | Iterable[str] = DEFAULT_CASE,
    duration: float | None = None,
    seed: int = 0,
    jobs: int = 1,
    learn: bool = False,
    progress: Progress = False,
) -> list[StressRow]:
    """Run every controller on every arm in the chosen scenarios.

    Args:
        arms: arms, or what `load_arm` takes.
        controllers: names of laws, or makers `(arm, dt) -> Controller` by label; all laws by
            default. A law by name runs with its preset for practice, or its default gains. A maker
            is called anew for each run, with the nominal arm and the tick of the case.
        scenarios: "sine", "hold", "moves", "rotors", "delay", "slow", "stribeck", "light",
            "elastic", "encoder", "task" (`evaluation.stress.SCENARIOS` says what each is), "all",
            or labels of single cases, such as "hold raw". By default sinusoids with both arms as
            their files say.
        duration: simulated time of each run [s]; None for the course's own. Sinusoids and holds are
            scaled to it, moves are cut short.
        seed: of the noise.
        jobs: processes on this machine; -1 for one per core. The rows are the same.
        learn: let every controller learn its model while the arm moves (`ModelLearning`, which is
            told by how many ticks the case delays the torque); the rows are labelled "… +
            learning".
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        One row per arm, controller and case, in this order.

    Raises:
        ArgumentError: an unknown name of a law or scenario.
        ArmNotFoundError: an unknown arm.

    Warns:
        GravityWarning: gravity asks an arm for more than its effort limits.
        BandwidthWarning: a law is too fast for the springs of a case "elastic".
    """
    loaded = [load_arm(arm) if isinstance(arm, str) else arm for arm in arms]
    makers, cases = _makers(controllers), chosen_cases(scenarios)
    for arm in loaded:  # here, because what another process warns of is not heard
        warn_of_gravity(arm)
    runs = [
        Run(case, arm, f"{label}{LABEL}" if learn else label, make, duration, seed, learn)
        for arm in loaded
        for label, make in makers.items()
        for case in cases
        if case.suits(arm) or len(cases) == 1
    ]
    rows = []
    with reporting(progress, ", ".join(arm.name for arm in loaded)) as report:
        for row in carried_out(runs, jobs):
            rows.append(row)
            report(len(rows) / len(runs))
    return rows


@dataclass(frozen=True)
class Run:
    """One cell of the matrix, to be run here or in another process."""

    case: Case
    arm: Arm
    label: str
    make: Maker
    duration: float | None
    seed: int
    learn: bool

    def __call__(self) -> StressRow:
        """Carry it out."""
        scenario = self.case.scenario_of(self.arm, duration=self.duration, seed=self.seed)
        made: Any = self.make(scenario.arm, scenario.dt)
        if self.case.course == "task":
            made = TaskSpace(scenario.arm, scenario.dt, law=self.make)
        law = fitted_to_springs(made, scenario)
        controller = with_learning(law, scenario.delay) if self.learn else law
        return run_row(scenario, controller, self.label)


def carried_out(runs: Sequence[Callable[[], Result]], jobs: int) -> Iterator[Result]:
    """Yield what each of the runs returns, in their order, from so many processes."""
    if jobs == 1 or len(runs) < 2:
        yield from (run() for run in runs)
        return
    parallel = joblib.Parallel(n_jobs=jobs, backend="loky", return_as="generator")
    yield from parallel(joblib.delayed(_call)(run) for run in runs)


def _call(run: Callable[[], Result]) -> Result:
    return run()


def _makers(controllers: Iterable[str] | Mapping[str, Maker] | None) -> dict[str, Maker]:
    if controllers is None:
        controllers = CONTROLLERS
    if not isinstance(controllers, dict) or controllers is CONTROLLERS:
        laws = [
            CONTROLLERS[checks.choice("controllers", name, [*CONTROLLERS])] for name in controllers
        ]
        return {law.__name__: law_maker(law) for law in laws}
    return dict(controllers)


def law_maker(law: type[Controller]) -> Maker:
    """Return a function that makes a controller of `law` with its preset for practical use."""
    preset = next((name for name in PREFERRED_PRESETS if name in law.presets), None)
    return lambda arm, dt: law(arm, dt, preset=preset)
