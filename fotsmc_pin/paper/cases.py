"""The cases of the comparison: the paper's two-link arm, and two real arms with a wrong model."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms import load_arm, perturb
from fotsmc_pin.paper import two_link
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import simulate

if TYPE_CHECKING:
    from collections.abc import Callable

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.simulation import Recording

MASS_SCALE, PAYLOAD, START_ERROR = 1.3, 2.0, 0.1
"""The cases with real arms: scale of masses, payload [kg], start error of each joint [rad]."""


@dataclass(frozen=True, kw_only=True)
class ComparisonCase:
    """One setting in which all laws compete.

    Attributes:
        title: in tables.
        nominal: returns the arm that the laws know.
        run: simulates a law for a duration [s].
        duration: of a run [s].
        peak_torque: no torque may be above this [N·m].
        torque_variation: nor the torque variation over the last half, in the second match [N·m/s].
    """

    title: str
    nominal: Callable[[], Arm]
    run: Callable[[Controller, float], Recording]
    duration: float
    peak_torque: float
    torque_variation: float


def _run_two_link(law: Controller, duration: float) -> Recording:
    return two_link.run(law, duration=duration, substeps=1)


def _real_arm(name: str) -> ComparisonCase:
    @cache
    def nominal() -> Arm:
        return load_arm(name)

    @cache
    def setting() -> tuple[Any, Arm, Any]:
        reference = Sinusoid.inside_limits(nominal())
        true = perturb(nominal(), mass_scale=MASS_SCALE, payload=PAYLOAD)
        start, _, _ = reference(0.0)
        return reference, true, nominal().integrate(start, np.full(nominal().nv, START_ERROR))

    def run(law: Controller, duration: float) -> Recording:
        reference, true, start = setting()
        return simulate(true, law, reference, duration, q0=start)

    return ComparisonCase(
        title=f"{name}, masses +30 %, {PAYLOAD:g} kg payload, start error {START_ERROR:g} rad",
        nominal=nominal,
        run=run,
        duration=6.0,
        peak_torque=math.inf,
        torque_variation=300.0,
    )


CASES: dict[str, ComparisonCase] = {
    "two_link": ComparisonCase(
        title="the paper's two-link case",
        nominal=two_link.nominal_arm,
        run=_run_two_link,
        duration=two_link.DURATION,
        peak_torque=365.0,
        torque_variation=100.0,
    ),
    "panda": _real_arm("panda"),
    "ur5": _real_arm("ur5"),
}
"""The two-link limits: the paper's gains take 362 N·m, and the reference with its disturbance
cannot be followed with less than about 10 N·m/s. The real arms have their own torque limits."""
