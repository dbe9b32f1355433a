"""`Case`: a column of the matrix in numbers, and `SCENARIOS`, all of them by scenario.

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
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import perturb
from fotsmc_pin.control import warn_of_gravity
from fotsmc_pin.errors import ArgumentError
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
from fotsmc_pin.evaluation.stress.wording import plant_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.courses import Course

CourseName: TypeAlias = Literal["sine", "hold", "moves", "sine, then rest"]

ROTORS = 150.0
"""Effort limit over true armature [rad/s², m/s²] where a case says nothing else."""
ALL = "all"


@dataclass(frozen=True, kw_only=True)
class Case:
    """One column of the matrix: a scenario, or one of its variants.

    Attributes:
        scenario: name of the scenario.
        variant: what tells it from the scenario's other cases.
        course: what the arm is to do.
        rotors: effort limit over the true armature; None leaves both arms as their files say.
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
        nominal = bare
        if self.tool == "nominal":
            nominal = perturb(bare, payload=mass, name=arm.name)
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
        start = course.reference(0.0)[0]
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
            text=f"{course.text}. {plant_text(self, bare, mass)}",
            frictionless=plant(friction=False) if self.frictionless_twin else None,
        )

    def _course(self, arm: Arm, payload: float, duration: float | None) -> Course:
        """Return the course; poses and moves are those that the heaviest plant can do."""
        if duration is not None:
            checks.finite_number("duration", duration, above=0.0)
        times = () if duration is None else (duration,)
        if self.course == "sine":
            return sine(arm, *times)
        if self.course == "sine, then rest":
            return sine_to_a_halt(arm, *times)
        bare = with_rotors(arm)
        heaviest = stress_plant(bare, payload=payload, armature=true_armature(bare, ROTORS))
        if self.course == "hold":
            return hold(arm, heaviest, *times)
        course = moves(arm, heaviest)
        return course if duration is None else lasting(course, duration)


def _both_worlds(scenario: CourseName, *, frictionless_twin: bool = False) -> tuple[Case, Case]:
    """One case with both arms as their files say, and one with rotors in both."""
    raw = Case(
        scenario=scenario,
        variant="raw",
        course=scenario,
        rotors=None,
        frictionless_twin=frictionless_twin,
    )
    return raw, replace(raw, variant="rotors", rotors=ROTORS)


SCENARIOS: Mapping[str, tuple[Case, ...]] = MappingProxyType(
    {
        "sine": _both_worlds("sine"),
        "hold": _both_worlds("hold", frictionless_twin=True),
        "moves": _both_worlds("moves"),
        "rotors": tuple(
            Case(scenario="rotors", variant=f"1/{divisor:g}", rotors=divisor)
            for divisor in (400.0, 100.0, 50.0)
        ),
        "delay": (Case(scenario="delay", delay=2),),
        "slow": tuple(
            Case(scenario="slow", variant=f"{1e3 * dt:g} ms", dt=dt) for dt in (2e-3, 4e-3)
        ),
        "stribeck": (Case(scenario="stribeck", stiction=1.5, stribeck_velocity=0.05),),
        "light": (Case(scenario="light", mass_scale=1.0, tool="nominal"),),
        "elastic": tuple(
            Case(
                scenario="elastic",
                variant=f"×{stiffness:g} {side}",
                stiffness=stiffness,
                encoder=side,
            )
            for side in ("motor", "link")
            for stiffness in (1000.0, 200.0, 100.0)
        ),
        "encoder": tuple(
            Case(scenario="encoder", variant=f"{bits} bits", bits=bits) for bits in (20, 17)
        ),
    }
)
"""The cases of each scenario, in the order of the table's columns.

- `sine`: a sinusoid in each joint for 6 s; both worlds: "raw", both arms as their files say, and
  "rotors", true armature limit / 150 beside the nominal's by rule.
- `hold`: one pose for 20 s, in both worlds, and the same without friction to compare with.
- `moves`: three moves from rest to rest with rests of 3 s, in both worlds.
- `rotors`: true armature limit / 400, / 100 and / 50 beside the nominal's by rule.
- `delay`: two ticks.
- `slow`: ticks of 2 and 4 ms, the torque one such tick late.
- `stribeck`: breakaway at 1.5 times Coulomb friction, falling over 0.05 rad/s.
- `light`: the nominal arm has the rated payload, the true one has not, and links as heavy as
  believed.
- `elastic`: joints with springs of limit × 1000, 200, 100 per radian, encoders on the motors and on
  the links.
- `encoder`: encoders of 20 and 17 bits, no velocity sensor and no other noise.

From `rotors` on the course is the sinusoid of `sine`, faded out after 6 s, and rest from 8 to 12 s.
"""


def chosen_cases(scenarios: str | Iterable[str]) -> list[Case]:
    """Return the cases of scenarios, each once, in the order of the table.

    Args:
        scenarios: names of scenarios, labels of single cases such as "sine raw", or "all".

    Raises:
        ArgumentError: an unknown name.
    """
    wanted = [scenarios] if isinstance(scenarios, str) else [*scenarios]
    every = [case for cases in SCENARIOS.values() for case in cases]
    if not wanted:
        raise ArgumentError("scenarios", wanted, f"choose some of {', '.join(SCENARIOS)}, {ALL}")
    labels = {case.label for case in every}
    for name in wanted:
        if name not in labels:
            checks.choice("scenarios", name, [*SCENARIOS, ALL])
    return [
        case for case in every if ALL in wanted or case.scenario in wanted or case.label in wanted
    ]


def stress_scenario(
    arm: Arm, case: str = "sine raw", *, payload: float | None = None, seed: int = 0
) -> Scenario:
    """Return a scenario of an arm; by default the sinusoids with both arms as their files say.

    The plant has 30 % more mass in each link, the rated payload of the arm (or a tenth of its mass)
    at the tool, and 0.5 N·m Coulomb and 0.5 N·m·s/rad viscous friction in each joint; a joint whose
    effort limit is below 20 N·m has less of both, in proportion. Noise of 1e-5 rad and 1e-3 rad/s
    is on the measurements, the torque comes one tick late, every joint starts 0.2 rad off. The
    reference swings each joint inside the limits of the nominal arm. The other cases are described
    in `SCENARIOS`.

    Args:
        arm: the nominal arm.
        case: label of the case, such as "hold rotors" or "delay".
        payload: mass at the tool [kg]; None for the rated one.
        seed: of the noise.

    Raises:
        ArgumentError: an unknown case, a negative payload or seed.

    Warns:
        GravityWarning: gravity asks the arm for more than its effort limits.
    """
    every = {each.label: each for cases in SCENARIOS.values() for each in cases}
    found = every[checks.choice("case", case, [*every])]
    return found.scenario_of(arm, payload=payload, seed=seed)
