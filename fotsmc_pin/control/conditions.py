"""What must hold for a law to keep its promise, and the warnings where it does not."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gains import Gains

SAMPLES = 200
POWERS = {"1/s": 1, "rad/s": 1, "1/s²": 2, "1/s³": 3}
"""Units of gains that are rates, with the power of the rate that they are."""
FILTERS = frozenset({"filter_rate"})
"""Rates that may be as high as they like: a filter that fast lets everything through."""
SPEEDS = frozenset({"approach"})
"""Speeds of joints in rad/s, which are no rates."""
LARGEST_STEP = 0.5
"""Product of a rate and the period above which a sampled loop has lost its damping."""


class PaperConditionWarning(UserWarning):
    """The chosen gains break a condition that the paper's own proof demands."""


class GravityWarning(UserWarning):
    """Gravity asks a joint for more than its effort limit in a configuration that it can reach."""


class TickWarning(UserWarning):
    """The ticks are too slow for the rates that the gains ask for."""


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


def warn_of_slow_ticks(gains: Gains, dt: float, law: object = None) -> None:
    """Warn where the period of a tick is too long for a gain that is a rate.

    A loop that decays at the rate `r` and is sampled each `dt` keeps its damping while `r dt` is
    small; above 0.5 it rings, above 2 it diverges (`(1 - r dt)^k`).

    Args:
        gains: of the law; those with the unit of a rate, or of its square or cube, count.
        dt: period of a tick [s].
        law: the controller in the making, if there is one.

    Warns:
        TickWarning: which gains, and the longest period that they bear.
    """
    rates = {
        f.name: float(np.max(getattr(gains, f.name))) ** (1.0 / POWERS[f.metadata["unit"]])
        for f in fields(gains)
        if f.metadata.get("unit") in POWERS and f.name not in FILTERS | SPEEDS
    }
    too_fast = {name: rate for name, rate in rates.items() if rate * dt > LARGEST_STEP}
    if too_fast:
        shown = ", ".join(f"{name} ({rate:.3g} rad/s)" for name, rate in too_fast.items())
        longest = LARGEST_STEP / max(too_fast.values())
        warn_user(
            f"ticks of {1e3 * dt:.3g} ms are slow for {shown}: take at most "
            f"{1e3 * longest:.2g} ms, or lower these gains",
            TickWarning,
            law,
        )
