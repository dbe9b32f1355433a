"""Scenarios with random plant, course, noise, delay and start, each from its own seed."""

from __future__ import annotations

import copy
import itertools
import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import joblib
import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import perturb
from fotsmc_pin.arms.random_numbers import Uniform
from fotsmc_pin.control import CONTROLLERS, Controller, RobustFONFTSM
from fotsmc_pin.evaluation.stress.courses import hold, lasting, moves, sine
from fotsmc_pin.evaluation.stress.judging import StressRow, run_row
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.evaluation.stress.plants import true_armature, with_rotors
from fotsmc_pin.evaluation.stress.scenario import DT, Scenario
from fotsmc_pin.evaluation.stress.suite import carried_out, law_maker
from fotsmc_pin.evaluation.stress.table import DRAWN
from fotsmc_pin.learning import ModelLearning
from fotsmc_pin.learning.described import LABEL
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.courses import Course
    from fotsmc_pin.progress import Progress

DURATION = 4.0
LIGHTEST_ROTORS, HEAVIEST_ROTORS = 800.0, 50.0
"""Range of effort limit over true armature [rad/s², m/s²]."""
AT_A_TIME = 20
"""Random scenarios that a process takes at a time."""
COURSES = ("sine", "moves", "hold")


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


def random_scenario(arm: Arm, seed: int, *, duration: float = DURATION) -> Scenario:
    """Return a scenario whose every number is drawn from one seed.

    The nominal arm has rotors by rule, effort limit / 200, where its file gives none. Drawn for the
    true arm, evenly: for each link a factor of 0.7 to 1.5 on its mass and a centre of mass up to
    20 mm away, a payload up to the rated one; for each joint a Coulomb friction up to 1 N·m, with
    breakaway at 1 to 1.5 times that, falling over 0.02 to 0.1 rad/s (Stribeck), a viscous friction
    up to 1 N·m·s/rad and a start error within 0.3 rad; a delay of 0, 1 or 2 ticks; position noise
    of up to 3e-5 rad and velocity noise of up to 3e-3 rad/s; and what to do: sinusoids, moves (with
    half a second of rest before the first and one after each) or a hold. The rotor of each joint
    is drawn from effort limit / 800 to / 50, evenly in its logarithm. The friction of a joint whose
    effort limit is below 20 N·m is not scaled down.

    Args:
        arm: the nominal arm, as it was loaded.
        seed: of the numbers.
        duration: simulated time [s]; the last half is judged.
    """
    rng = np.random.default_rng([checks.count("seed", seed, at_least=0), 7])
    nominal = with_rotors(arm)
    start_error = rng.uniform(-0.3, 0.3, arm.nv)
    position_noise = float(rng.uniform(0.0, 3e-5))
    velocity_noise = float(rng.uniform(0.0, 3e-3))
    delay = int(rng.integers(0, 3))
    exponents = rng.uniform(np.log(HEAVIEST_ROTORS), np.log(LIGHTEST_ROTORS), arm.nv)
    what = COURSES[int(rng.integers(len(COURSES)))]
    true = perturb(
        nominal,
        mass_scale=Uniform(0.7, 1.5),
        com_shift=Uniform(0.0, 0.02),
        payload=Uniform(0.0, stress_payload(arm)),
        friction=Uniform(0.0, 1.0),
        damping=Uniform(0.0, 1.0),
        stiction=Uniform(1.0, 1.5),
        stribeck_velocity=Uniform(0.02, 0.1),
        armature=true_armature(nominal, np.exp(exponents)),
        seed=seed,
    )
    course = _course(what, arm, true, duration)
    return Scenario(
        arm=nominal,
        true=true,
        course=course,
        q0=arm.integrate(course.reference(0.0)[0], start_error),
        position_noise=position_noise,
        velocity_noise=velocity_noise,
        delay=delay,
        seed=seed,
        name=what,
        variant=DRAWN,
        text=f"{course.text}. {'; '.join(true.changes)}. Torque {delay} ticks late, noise of "
        f"{position_noise:.2g} rad and {velocity_noise:.2g} rad/s.",
    )


def _course(what: str, arm: Arm, true: Arm, duration: float) -> Course:
    if what == "sine":
        return sine(arm, duration)
    if what == "hold":
        return hold(arm, true, duration)
    course = lasting(moves(arm, true, first_dwell=0.5, dwell=1.0), duration)
    return replace(course, judged=(0.5 * duration, duration))


def run_random_scenarios(
    arm: Arm,
    count: int = 1000,
    *,
    law: type[Controller] | str = RobustFONFTSM,
    first_seed: int = 0,
    duration: float = DURATION,
    jobs: int = 1,
    learn: bool = False,
    progress: Progress = False,
) -> list[SeededRow]:
    """Run a law in many random scenarios, worst first: diverged ones, then by tail RMS error.

    Args:
        arm: the nominal arm.
        count: number of scenarios.
        law: the law, or its name; it runs with its preset for practice, or its default gains.
        first_seed: seed of the first scenario; the others have the seeds after it.
        duration: simulated time of each run [s].
        jobs: processes on this machine; -1 for one per core. The rows are the same.
        learn: let the law learn its model while the arm moves (`ModelLearning`, which is told by
            how many ticks the torque is late); it begins anew in each scenario.
        progress: True shows a bar on standard error; a callable is told the fraction done.
    """
    if isinstance(law, str):
        law = CONTROLLERS[checks.choice("law", law, [*CONTROLLERS])]
    checks.count("count", count)
    label = f"{law.__name__}{LABEL}" if learn else law.__name__
    draws = _Draws(arm, law, label, range(first_seed, first_seed + count), duration, learn)
    done = []
    with reporting(progress, f"{label}, {arm.name}") as report:
        for row in draws.rows() if jobs == 1 else draws.rows_of_processes(jobs):
            done.append(row)
            report(len(done) / count)
    return sorted(done, key=lambda found: (not found.row.diverged, -found.row.tail_rms_error))


@dataclass(frozen=True)
class _Draws:
    """Random scenarios of a law, to be run here or in another process."""

    arm: Arm
    law: type[Controller]
    label: str
    seeds: range
    duration: float
    learn: bool

    def rows(self) -> Iterator[SeededRow]:
        """Yield the result of each, by controllers that are made once: learning ones take 2 s."""
        plain = law_maker(self.law)(with_rotors(self.arm), DT)
        learners: dict[int, ModelLearning] = {}
        for seed in self.seeds:
            scenario = random_scenario(self.arm, seed, duration=self.duration)
            if self.learn and scenario.delay not in learners:
                own = copy.deepcopy(plain)
                learners[scenario.delay] = ModelLearning(own, delay=scenario.delay)
            controller = learners[scenario.delay] if self.learn else plain
            yield SeededRow(seed=seed, row=run_row(scenario, controller, self.label))

    def rows_of_processes(self, jobs: int) -> Iterator[SeededRow]:
        """Yield the same from so many processes, each of which takes several seeds at a time."""
        share = math.ceil(len(self.seeds) / joblib.effective_n_jobs(jobs))
        size = min(AT_A_TIME, share)
        parts = [
            replace(self, seeds=self.seeds[start : start + size])
            for start in range(0, len(self.seeds), size)
        ]
        return itertools.chain.from_iterable(carried_out(parts, jobs))

    def __call__(self) -> list[SeededRow]:
        return [*self.rows()]
