"""Scenarios with random perturbation, noise, friction, delay and start, each from its own seed."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import perturb
from fotsmc_pin.arms.random_numbers import Uniform
from fotsmc_pin.control import CONTROLLERS, Controller, RobustFONFTSM
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.evaluation.stress.scenario import DT, Scenario
from fotsmc_pin.evaluation.stress.table import StressRow, run_row
from fotsmc_pin.progress import reporting
from fotsmc_pin.references import Sinusoid

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.progress import Progress

DURATION = 4.0


@dataclass(frozen=True, kw_only=True)
class SeededRow:
    """The result in a random scenario, and the seed that reproduces the scenario.

    Attributes:
        seed: of `random_scenario`.
        row: the result.
    """

    seed: int
    row: StressRow

    def as_dict(self) -> dict[str, Any]:
        """Return seed and result as plain data."""
        return {"seed": self.seed, **asdict(self.row)}


def random_scenario(arm: Arm, seed: int) -> Scenario:
    """Return a scenario whose every number is drawn from one seed.

    Evenly drawn: for each link a factor of 0.7 to 1.5 on its mass and a centre of mass up to 20 mm
    away, a payload up to the rated one, for each joint a Coulomb friction up to 1 N·m and a viscous
    one up to 1 N·m·s/rad, a start error within 0.3 rad for each joint, a delay of 0, 1 or 2 ticks;
    position noise of up to 3e-5 rad and velocity noise of up to 3e-3 rad/s. The friction of a joint
    whose effort limit is below 20 N·m is not scaled down.

    Args:
        arm: the nominal arm.
        seed: of the numbers.
    """
    rng = np.random.default_rng([checks.count("seed", seed, at_least=0), 7])
    true = perturb(
        arm,
        mass_scale=Uniform(0.7, 1.5),
        com_shift=Uniform(0.0, 0.02),
        payload=Uniform(0.0, stress_payload(arm)),
        friction=Uniform(0.0, 1.0),
        damping=Uniform(0.0, 1.0),
        seed=seed,
    )
    reference = Sinusoid.inside_limits(arm)
    return Scenario(
        arm=arm,
        true=true,
        reference=reference,
        q0=arm.integrate(reference(0.0)[0], rng.uniform(-0.3, 0.3, arm.nv)),
        position_noise=float(rng.uniform(0.0, 3e-5)),
        velocity_noise=float(rng.uniform(0.0, 3e-3)),
        delay=int(rng.integers(0, 3)),
        seed=seed,
    )


def run_random_scenarios(
    arm: Arm,
    count: int = 1000,
    *,
    law: type[Controller] | str = RobustFONFTSM,
    first_seed: int = 0,
    duration: float = DURATION,
    progress: Progress = False,
) -> list[SeededRow]:
    """Run a law in many random scenarios, worst first: diverged ones, then by tail RMS error.

    Args:
        arm: the nominal arm.
        count: number of scenarios.
        law: the law, or its name, with its default gains.
        first_seed: seed of the first scenario; the others have the seeds after it.
        duration: simulated time of each run [s].
        progress: True shows a bar on standard error; a callable is told the fraction done.
    """
    if isinstance(law, str):
        law = CONTROLLERS[checks.choice("law", law, [*CONTROLLERS])]
    controller, done = law(arm, DT), []
    checks.count("count", count)
    with reporting(progress, f"{law.__name__}, {arm.name}") as report:
        for seed in range(first_seed, first_seed + count):
            row = run_row(random_scenario(arm, seed), controller, law.__name__, duration)
            done.append(SeededRow(seed=seed, row=row))
            report(len(done) / count)
    return sorted(done, key=lambda found: (not found.row.diverged, -found.row.tail_rms_error))
