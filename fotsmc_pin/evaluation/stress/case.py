"""`Case`: a column of the matrix in numbers, which make it for any arm.

A case states what is wrong with the plant; `Case.scenario_of` makes it for an arm, and the text of
the result says it in words, with that arm's numbers. Where a case says nothing else, the true arm
has 30 % more mass in each link, its rated payload (`payloads.stress_payload`) at the tool, 0.5 N·m
Coulomb and 0.5 N·m·s/rad viscous friction in each joint (in proportion less below 20 N·m of effort
limit), rotors of effort limit / 150 beside the nominal arm's by rule, limit / 200. Measurements
have noise of 1e-5 rad and 1e-3 rad/s, a tick is 1 ms, the torque comes a tick late, and every joint
starts 0.2 rad off. For joints without an effort limit see `plants.drive_size`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import perturb
from fotsmc_pin.control import warn_of_gravity
from fotsmc_pin.evaluation.stress.courses import hold, lasting, moves, sine, sine_to_a_halt
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.evaluation.stress.plants import (
    MASS_SCALE,
    stress_plant,
    true_armature,
    with_rotors,
)
from fotsmc_pin.evaluation.stress.scenario import (
    DELAY,
    DT,
    PLANT_STEP,
    POSITION_NOISE,
    START_ERROR,
    VELOCITY_NOISE,
    Scenario,
)
from fotsmc_pin.evaluation.stress.task_course import POSE_SIZE, task
from fotsmc_pin.evaluation.stress.wording import plant_text

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.courses import Course
    from fotsmc_pin.types import Array

CourseName: TypeAlias = Literal["sine", "hold", "moves", "sine, then rest", "task"]

ROTORS = 150.0
"""Effort limit over true armature [rad/s², m/s²] where a case says nothing else."""
LEARNT = 5.0 / 12.0
"""Share of a run from which on a law counts that has to find the rotors by itself."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One column of the matrix: a scenario, or one of its variants.

    Attributes:
        scenario: name of the scenario.
        variant: what tells it from the scenario's other cases.
        course: what the arm is to do.
        rotors: effort limit over the true armature; None leaves both arms as their files say.
        known_rotors: whether the nominal arm has rotors by rule where the true one has any; if not
            it is as its file says, and the error counts from 5 s on, halt and rest included.
        delay: ticks that the torque comes late.
        dt: period of a tick [s].
        mass_scale: factor on the mass of each link of the true arm.
        tool: which arm has the rated payload: the true one alone, or the nominal one alone.
        stiction: friction at breakaway over Coulomb friction; None for 1.
        stribeck_velocity: speed of its fall [rad/s, m/s].
        stiffness: of the joints' springs over the effort limit [1/rad, 1/m]; None for rigid joints.
        encoder: side of the springs on which the encoders sit.
        bits: of the encoders, in place of noise and of a velocity sensor; None for those.
        frictionless_twin: run the same without friction too, to compare the torque variation.
    """

    scenario: str
    variant: str = ""
    course: CourseName = "sine, then rest"
    rotors: float | None = ROTORS
    known_rotors: bool = True
    delay: int = DELAY
    dt: float = DT
    mass_scale: float = MASS_SCALE
    tool: Literal["true", "nominal"] = "true"
    stiction: float | None = None
    stribeck_velocity: float | None = None
    stiffness: float | None = None
    encoder: Literal["motor", "link"] = "motor"
    bits: int | None = None
    frictionless_twin: bool = False

    @property
    def label(self) -> str:
        """Scenario and variant, as the column is headed and as it is chosen."""
        return f"{self.scenario} {self.variant}".rstrip()

    def scenario_of(
        self,
        arm: Arm,
        *,
        payload: float | None = None,
        duration: float | None = None,
        seed: int = 0,
    ) -> Scenario:
        """Return the closed loop of this case with an arm.

        Args:
            arm: the arm as it was loaded.
            payload: mass of the tool [kg]; None for the rated one.
            duration: simulated time [s]; None for the course's own. Sinusoids and holds are scaled
                to it, moves are cut short.
            seed: of the noise.

        Warns:
            GravityWarning: gravity asks the arm for more than its effort limits.
        """
        warn_of_gravity(arm)
        mass = stress_payload(arm) if payload is None else payload
        mass = checks.finite_number("payload", mass, at_least=0.0)
        seed = checks.count("seed", seed, at_least=0)
        bare = arm if self.rotors is None else with_rotors(arm)
        nominal = bare if self.known_rotors else arm
        if self.tool == "nominal":
            nominal = perturb(nominal, payload=mass, name=arm.name)
        armature = None if self.rotors is None else true_armature(bare, self.rotors)

        def plant(*, friction: bool = True) -> Arm:
            return stress_plant(
                bare,
                payload=mass if self.tool == "true" else 0.0,
                mass_scale=self.mass_scale,
                armature=armature,
                stiction=self.stiction,
                stribeck_velocity=self.stribeck_velocity,
                stiffness=self.stiffness,
                friction=friction,
            )

        course = self._course(arm, mass, duration)
        start = self._start(course)
        return Scenario(
            arm=nominal,
            true=plant(),
            course=course,
            q0=arm.integrate(start, np.full(arm.nv, START_ERROR)),
            position_noise=POSITION_NOISE if self.bits is None else 0.0,
            velocity_noise=VELOCITY_NOISE if self.bits is None else 0.0,
            bits=self.bits,
            encoder=self.encoder,
            delay=self.delay,
            dt=self.dt,
            substeps=round(self.dt / PLANT_STEP),
            seed=seed,
            name=self.scenario,
            variant=self.variant,
            text=f"{course.text}. {plant_text(self, nominal, bare, mass)}",
            frictionless=plant(friction=False) if self.frictionless_twin else None,
        )

    def suits(self, arm: Arm) -> bool:
        """Return whether an arm can be run in it: a task needs six joints."""
        return self.course != "task" or arm.nv >= POSE_SIZE

    def _start(self, course: Course) -> Array:
        """Return the configuration (nq,) in which the reference begins."""
        reference: Any = course.reference
        start: Array = reference.q_start if self.course == "task" else reference(0.0)[0]
        return start

    def _course(self, arm: Arm, payload: float, duration: float | None) -> Course:
        """Return the course; poses and moves are those that the heaviest plant can do."""
        if duration is not None:
            checks.finite_number("duration", duration, above=0.0)
        times = () if duration is None else (duration,)
        if self.course == "sine":
            return sine(arm, *times)
        if self.course == "sine, then rest":
            course = sine_to_a_halt(arm, *times)
            if self.known_rotors:
                return course
            return replace(course, judged=(LEARNT * course.duration, course.duration))
        if self.course == "task":
            rotors = with_rotors(arm)
            heavy = stress_plant(rotors, payload=payload, armature=true_armature(rotors, ROTORS))
            return task(arm, heavy, *times)
        bare = with_rotors(arm)
        heaviest = stress_plant(bare, payload=payload, armature=true_armature(bare, ROTORS))
        if self.course == "hold":
            return hold(arm, heaviest, *times)
        course = moves(arm, heaviest)
        return course if duration is None else lasting(course, duration)
