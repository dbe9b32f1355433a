"""`stress`: every controller on every arm, in the scenario that is hard on all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from fotsmc_pin import checks
from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import CONTROLLERS, Controller
from fotsmc_pin.evaluation.stress.scenario import DT, DURATION, stress_scenario
from fotsmc_pin.evaluation.stress.table import StressRow, run_row
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.progress import Progress

    Maker: TypeAlias = Callable[[Arm, float], Controller]

PREFERRED_PRESETS = ("practical", "pid", "boundary_layer")
"""Presets for practical use, the first that a law has; its first preset is its printed form."""


def stress(
    arms: Iterable[Arm | str],
    controllers: Iterable[str] | Mapping[str, Maker] | None = None,
    *,
    duration: float = DURATION,
    seed: int = 0,
    progress: Progress = False,
) -> list[StressRow]:
    """Run every controller on every arm in the stress scenario (`stress_scenario`), at 1 kHz.

    Args:
        arms: arms, or what `load_arm` takes.
        controllers: names of laws, or functions `(arm, dt) -> Controller` by label; all laws by
            default. A named law runs with its preset for practical use, or its default gains.
        duration: simulated time of each run [s]; the last half is the tail.
        seed: of the noise.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        One row per arm and controller.

    Raises:
        ArgumentError: an unknown name of a law.
        ArmNotFoundError: an unknown arm.

    Warns:
        GravityWarning: gravity asks an arm for more than its effort limits.
    """
    loaded = [load_arm(arm) if isinstance(arm, str) else arm for arm in arms]
    makers = _makers(controllers)
    rows = []
    with reporting(progress, ", ".join(arm.name for arm in loaded)) as report:
        for arm in loaded:
            scenario = stress_scenario(arm, seed=seed)
            for label, make in makers.items():
                rows.append(run_row(scenario, make(arm, DT), label, duration))
                report(len(rows) / (len(loaded) * len(makers)))
    return rows


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
