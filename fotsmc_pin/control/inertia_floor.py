"""A floor under the nominal inertia that each joint finds from the disturbance that it meets.

Wrists are light in their URDFs, and what they must overcome is not: friction of the gears, the
inertia of the motor, a payload. A law that multiplies its commanded acceleration with such an
inertia is too weak to break a joint loose. Adding a constant to the inertia would help, and would
make a light joint without friction unstable. So the floor `δ` follows the disturbance torque `d`
that the momentum observer sees: a joint that meets none keeps the inertia of its model.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

LARGEST_ACCELERATION = 150.0
"""Acceleration at which the largest floor asks for the whole effort limit [rad/s²]."""
OBSERVER_RATE = 15.0
"""Bandwidth in which a disturbance counts: above the arm's motion, below the loop's [rad/s]."""
MEAN_RATE = 1.0
"""Rate at which the lasting part of a disturbance is told apart, such as a weight [1/s]."""
RISE, LEAK = 3.0, 0.15
"""Rates at which the floor follows upward, and at which it is forgotten [1/s]."""
DEAD_ZONE = 0.05
"""Disturbances too small to give the bare joint this acceleration are none [rad/s²]."""
FAR = 0.02
"""Error at which a joint counts as not arrived: what it meets on its way is not learnt [rad]."""


def largest_floor(arm: Arm) -> Array:
    """Return the most that is ever added to a joint's inertia, (nv,) [kg·m²]: `τ_max / 150 rad/s²`.

    A motor is chosen with its load in mind: one that could not accelerate the floor at 150 rad/s²
    was not built for such an inertia. Infinite where the arm states no effort limit.
    """
    limit: Array = arm.effort_limit / LARGEST_ACCELERATION
    return limit


@kernel
def raise_floor(
    dt: float,
    e: Array,
    M0: Array,
    d: Array,
    share: Array,
    largest: Array,
    mean: Array,
    floor: Array,
) -> None:
    """Move the floor `δ` (nv,) [kg·m²] by one tick.

        δ → share (|d - d̄| - dead zone),   up at the rate 3/s, down at 0.15/s
        d̄ → d                              at the rate 1/s

    The slow way down is the leakage. While the error is far above 20 mrad, the joint is on its way
    and meets what passes, such as torque limits: `d̄` follows at once and `δ` does not rise.

    Args:
        dt: time since the last tick [s].
        e: tracking error (nv,).
        M0: nominal mass matrix (nv, nv).
        d: disturbance torque (nv,).
        share: floor per disturbance torque (nv,) [s²/rad]; 0 keeps the floor at 0.
        largest: bound of the floor (nv,).
        mean: `d̄` (nv,), overwritten.
        floor: `δ` (nv,), overwritten.
    """
    for i in range(e.size):
        far = (e[i] / FAR) ** 2
        mean[i] += dt * (MEAN_RATE + OBSERVER_RATE * far / (1.0 + far)) * (d[i] - mean[i])
        met = max(abs(d[i] - mean[i]) - DEAD_ZONE * M0[i, i], 0.0)
        target = min(share[i] * met, largest[i])
        rate = RISE / (1.0 + far) if target > floor[i] else LEAK
        floor[i] += dt * rate * (target - floor[i])
