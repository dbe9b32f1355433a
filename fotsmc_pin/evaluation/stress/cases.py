"""`SCENARIOS`: every column of the matrix, and how one is chosen."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.stress.case import ROTORS, Case

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.case import CourseName
    from fotsmc_pin.evaluation.stress.scenario import Scenario

ALL = "all"


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
            Case(
                scenario="rotors",
                variant=f"1/{divisor:g}" if known else f"1/{divisor:g} unknown",
                rotors=divisor,
                known_rotors=known,
            )
            for known in (True, False)
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
                variant=f"{stiffness:g} {side}",
                stiffness=stiffness,
                encoder=side,
            )
            for side in ("motor", "link")
            for stiffness in (1000.0, 200.0, 100.0)
        ),
        "encoder": tuple(
            Case(scenario="encoder", variant=f"{bits} bits", bits=bits) for bits in (20, 17)
        ),
        "task": _both_worlds("task"),
    }
)
"""The cases of each scenario, in the order of the table's columns.

- `sine`: a sinusoid in each joint for 6 s; both worlds: "raw", both arms as their files say, and
  "rotors", true armature limit / 150 beside the nominal's by rule.
- `hold`: one pose for 20 s, in both worlds, and the same without friction to compare with.
- `moves`: three moves from rest to rest with rests of 3 s, in both worlds.
- `rotors`: true armature limit / 400, / 100 and / 50 beside the nominal's by rule; "unknown":
  beside a nominal arm that is as its file says, judged from 5 s on.
- `delay`: two ticks.
- `slow`: ticks of 2 and 4 ms, the torque one such tick late.
- `stribeck`: breakaway at 1.5 times Coulomb friction, falling over 0.05 rad/s.
- `light`: the nominal arm has the rated payload, the true one has not, and links as heavy as
  believed.
- `elastic`: joints with springs of limit × 1000, 200, 100 per radian, encoders on the motors and on
  the links; the law is in a `SpringObserver`, and one with a `bandwidth` runs at
  `fotsmc_pin.analysis.OBSERVED_SHARE` of `largest_bandwidth` at most.
- `encoder`: encoders of 20 and 17 bits, no velocity sensor and no other noise.

- `task`: the tool along a circle while it swings, in both worlds; there the law is that of a
  `TaskSpace`, and errors are those of joints from where it has them, and of the tool. Arms with
  fewer than six joints are left out.

From `rotors` to `encoder` the course is the sinusoid of `sine`, faded out after 6 s, and rest from
8 to 12 s.
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
