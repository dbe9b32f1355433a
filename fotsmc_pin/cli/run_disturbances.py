"""What disturbs a run of `fotsmc simulate`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.checks import choice
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, Disturbance

WORDS = ("none", "paper", "push")
PUSH_SHARE = 0.1
"""Torque of a push over the effort limit."""
PUSH_ACCELERATION = 10.0
"""Acceleration that a push gives to a joint without an effort limit [rad/s², m/s²]."""
PUSH_BEGIN, PUSH_LENGTH = 0.4, 0.2
"""When the push begins, as a share of the run, and how long it lasts [s]."""


def disturbance(word: str, arm: Arm, duration: float) -> Disturbance | None:
    """Return what a word of `--disturbance` stands for.

    Args:
        word: "none", "paper" for [38] on an arm of two joints, or "push".
        arm: the true arm.
        duration: of the run [s].

    Raises:
        ArgumentError: an unknown word, or one that does not fit the arm.
    """
    choice("--disturbance", word, WORDS)
    if word == "none":
        return None
    if word == "paper":
        from fotsmc_pin.paper.two_link import disturbance as of_paper

        if arm.nv != 2:
            raise ArgumentError(
                "--disturbance", "paper", f"is for two joints; {arm.name} has {arm.nv}"
            )
        return of_paper
    return Push(arm, PUSH_BEGIN * duration)


class Push:
    """One push on all joints: half a sine of a tenth of the effort limits, for 0.2 s."""

    def __init__(self, arm: Arm, begin: float) -> None:
        free = PUSH_ACCELERATION * np.diag(arm.mass_matrix(arm.neutral))
        limited = np.isfinite(arm.effort_limit)
        self.torque: Array = np.where(limited, PUSH_SHARE * arm.effort_limit, free)
        self.begin = begin

    def __call__(self, t: float) -> Array:
        """Return the torque at time `t` [s], (nv,) [N·m, N]."""
        share = (t - self.begin) / PUSH_LENGTH
        return self.torque * (math.sin(math.pi * share) if 0.0 < share < 1.0 else 0.0)
