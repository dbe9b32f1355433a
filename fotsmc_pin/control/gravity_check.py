"""A word before the run where an arm cannot hold itself up."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

SAMPLES = 200


class GravityWarning(UserWarning):
    """Gravity asks a joint for more than its effort limit in a configuration that it can reach."""


def warn_of_gravity(arm: Arm, *, stacklevel: int = 1) -> None:
    """Warn where the nominal gravity exceeds the effort limits of an arm.

    Tried at the neutral and at 200 random configurations, always the same ones.

    Args:
        arm: the arm.
        stacklevel: 1 lets the warning point at the caller, 2 at the caller of that, and so on.

    Warns:
        GravityWarning: which joint, by how much, and what to do.
    """
    rng = np.random.default_rng(0)
    configurations = [arm.neutral, *(arm.random_configuration(rng) for _ in range(SAMPLES))]
    share = np.max([np.abs(arm.gravity(q)) for q in configurations], axis=0) / arm.effort_limit
    too_heavy = [
        f"{name} ({ratio:.2f} times)"
        for name, ratio in zip(arm.joint_names, share, strict=True)
        if ratio > 1.0
    ]
    if too_heavy:
        warnings.warn(
            f"{arm.name}: gravity exceeds the effort limit of {', '.join(too_heavy)}: no "
            "controller can hold the arm everywhere; stay where it can be held, or give "
            "load_arm(effort_limit=...) the true limits",
            GravityWarning,
            stacklevel=stacklevel + 1,
        )
