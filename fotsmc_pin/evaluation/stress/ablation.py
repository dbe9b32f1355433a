"""What each ingredient of `RobustFONFTSM` is worth: the law without it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fotsmc_pin.control import RobustFONFTSM
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.judging import StressRow
    from fotsmc_pin.progress import Progress

VARIANTS: Mapping[str, Mapping[str, Any]] = {
    "everything on": {},
    "integer order (α = 0)": {"alpha": 0.0},
    "no tempering (σ = 0)": {"tempering": 0.0},
    "no terminal term (λ = 0)": {"lam": 0.0},
    "no way led home (v_a = ∞)": {"approach": math.inf},
    "no bound on the reach (ē = 1000 rad)": {"reach": 1e3},
    "no integral (b = 0)": {"integral": 0.0},
    "no disturbance observer (K = 0)": {"observer": 0.0},
    "no inertia floor": {"floor_share": 0.0},
    "no search for rotors": {"rotor_limit": 0.0},
    "no anti-windup": {"anti_windup": False},
}
"""Gains that switch one ingredient off, by what they leave out."""


def ablate(
    run: Callable[[RobustFONFTSM, str], StressRow],
    arm: Arm,
    dt: float,
    *,
    progress: Progress = False,
) -> list[StressRow]:
    """Run each of `VARIANTS` in a scenario.

    Args:
        run: `(controller, label) -> row`: runs the scenario and returns its row.
        arm: the nominal arm.
        dt: period of a tick [s].
        progress: True shows a bar on standard error; a callable is told the fraction done.
    """
    rows = []
    with reporting(progress, f"ablation, {arm.name}") as report:
        for label, gains in VARIANTS.items():
            rows.append(run(RobustFONFTSM(arm, dt, **gains), label))
            report(len(rows) / len(VARIANTS))
    return rows
