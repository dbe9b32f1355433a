"""What must hold for a law to keep its promise, and the warnings where it does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

SAMPLES = 200


class PaperConditionWarning(UserWarning):
    """The chosen gains break a condition that the paper's own proof demands."""


class GravityWarning(UserWarning):
    """Gravity asks a joint for more than its effort limit in a configuration that it can reach."""


def obeys_power_condition(power: float) -> bool:
    """Return whether `1 < p/q < 2`, so that `|e|^{p/q-1}` in [20] is bounded at `e = 0`.

    Args:
        power: `p/q` of the surface [19].

    Source: the text below [19]; the paper simulates 0.9 (reading R2).
    """
    return 1.0 < power < 2.0


def warn_of_power(power: float, error_floor: float, law: object = None) -> None:
    """Warn where `p/q` breaks the condition, and say what holds the law together there.

    Args:
        power: `p/q` of the surface [19].
        error_floor: smallest `|e|` that enters `|e|^{p/q-1}` [rad].
        law: the controller in the making, if there is one.
    """
    if not obeys_power_condition(power):
        warn_user(
            f"power = {power:g} breaks the condition 1 < p/q < 2 that the paper's proof demands: "
            f"|e|^(p/q-1) is singular at e = 0 and is held by error_floor = {error_floor:g}",
            PaperConditionWarning,
            law,
        )


def warn_of_gravity(arm: Arm, law: object = None) -> None:
    """Warn where the nominal gravity exceeds the effort limits of an arm.

    Tried at the neutral and at 200 random configurations, always the same ones.

    Args:
        arm: the arm.
        law: the controller in the making, if there is one.

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
        warn_user(
            f"{arm.name}: gravity exceeds the effort limit of {', '.join(too_heavy)}: no "
            "controller can hold the arm everywhere; stay where it can be held, or give "
            "load_arm(effort_limit=...) the true limits",
            GravityWarning,
            law,
        )
