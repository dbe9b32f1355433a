"""What each ingredient of `RobustFONFTSM` is worth: the law without it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.control import RobustFONFTSM

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.stress_suite.table import StressRow

VARIANTS: Mapping[str, Mapping[str, Any]] = {
    "everything on": {},
    "integer order (α = 0)": {"alpha": 0.0},
    "no tempering (σ = 0)": {"tempering": 0.0},
    "no terminal term (λ = 0)": {"lam": 0.0},
    "no bound on the reach (ē = 1000 rad)": {"reach": 1e3},
    "no integral (b = 0)": {"integral": 0.0},
    "no disturbance observer (K = 0)": {"observer": 0.0},
    "no inertia floor": {"floor_share": 0.0},
    "no search for rotors": {"rotor_limit": 0.0},
    "no anti-windup": {"anti_windup": False},
}
"""Gains that switch one ingredient off, by what they leave out."""


def ablate(run: Callable[[RobustFONFTSM, str], StressRow], arm: Arm, dt: float) -> list[StressRow]:
    """Run each of `VARIANTS` on a case.

    Args:
        run: `(controller, label) -> row`, the case.
        arm: the nominal arm.
        dt: period of a tick [s].
    """
    return [run(RobustFONFTSM(arm, dt, **gains), label) for label, gains in VARIANTS.items()]
