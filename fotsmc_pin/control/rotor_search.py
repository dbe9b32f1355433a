"""Inertia that the model lacks, found from the oscillation that its lack causes.

A geared joint carries its motor's rotor, which no URDF states: the true inertia of a wrist may be a
thousand times the nominal one. A loop that multiplies its command with the nominal inertia bears a
certain ratio; beyond it oscillates, and the oscillation tells what is missing: the torque that the
model leaves unexplained is the missing inertia times the acceleration. So where a joint oscillates
for a while, its inertia is raised towards what explains it, and no further than until it is quiet.
A joint that does not oscillate keeps the inertia of its model, whatever friction or load it meets.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gains import Array

LARGEST_SHARE = 1.0 / 40.0
"""Largest rotor per effort limit [s²/rad]: geared arms have 1/400 to 1/50 of it."""
UPPER_BAND, LOWER_BAND = 60.0, 8.0
"""Band in which oscillation is looked for [rad/s]: above the arm's motion, below the noise."""
FORGETTING = 4.0
"""Rate at which an oscillation is forgotten [1/s]."""
OSCILLATION = 0.3
"""RMS acceleration from which on a joint oscillates [rad/s²]."""
LIKENESS = 0.7
"""Correlation of torque and acceleration from which on inertia is what joins them."""
SWINGS = 4
"""Changes of sign that make an oscillation: a transient has fewer."""
RISE, FALL = 0.8, 20.0
"""Rates at which missing inertia is made up, and at which surplus is taken away [1/s].

Slowly up: the loop is quiet long before all that is missing is found, and what is found at one pose
(of a payload) is not there at another. Fast down: too much oscillates at the rate of the ticks.
"""
FAR = 0.2
"""Error at which a joint counts as on its way: what its pose there asks for is not learnt [rad]."""


def largest_rotor(arm: Arm) -> Array:
    """Return the most that is ever found at a joint, (nv,) [kg·m²]; infinite without a limit."""
    limit: Array = arm.effort_limit * LARGEST_SHARE
    return limit


@kernel
def search_rotor(
    dt: float, e: Array, lacking: Array, a: Array, largest: Array, rotor: Array, probe: Array
) -> None:
    """Move the rotor inertias `J` (nv,) [kg·m²] by one tick.

    Torque and acceleration pass the same band-pass. With sums over the last quarter of a second,
    what is missing is `Σ τ a / Σ a²`, the least-squares estimate; after `SWINGS` of an oscillation

        J̇ = 0.8 Σ τ a / Σ a² upward, 20 Σ τ a / Σ a² downward,   0 ≤ J ≤ largest.

    Dry friction is in quadrature with the acceleration of an oscillation, and gravity changes
    slowly: neither biases the estimate, and too much of either spoils the correlation, so that
    nothing is learnt.

    Args:
        dt: time since the last tick [s].
        e: tracking error (nv,).
        lacking: torque that the model with `J` does not explain, over the last tick (nv,).
        a: acceleration beyond the reference's over the last tick (nv,).
        largest: bound of `J` (nv,).
        rotor: `J` (nv,), overwritten.
        probe: (11, nv), overwritten: three stages of the band-pass each, the three sums, changes of
            sign in the present oscillation, and the last acceleration.
    """
    up = UPPER_BAND * dt / (1.0 + UPPER_BAND * dt)
    down = LOWER_BAND * dt / (1.0 + LOWER_BAND * dt)
    forgetting = FORGETTING * dt / (1.0 + FORGETTING * dt)
    for i in range(a.size):
        probe[0, i] += up * (a[i] - probe[0, i])
        probe[1, i] += up * (probe[0, i] - probe[1, i])
        probe[2, i] += down * (probe[1, i] - probe[2, i])
        probe[3, i] += up * (lacking[i] - probe[3, i])
        probe[4, i] += up * (probe[3, i] - probe[4, i])
        probe[5, i] += down * (probe[4, i] - probe[5, i])
        moved, torque = probe[1, i] - probe[2, i], probe[4, i] - probe[5, i]
        probe[6, i] += forgetting * (moved * moved - probe[6, i])
        probe[7, i] += forgetting * (torque * torque - probe[7, i])
        probe[8, i] += forgetting * (torque * moved - probe[8, i])
        aa, tt, ta = probe[6, i], probe[7, i], probe[8, i]
        if aa > OSCILLATION**2 and abs(ta) > LIKENESS * math.sqrt(aa * tt):
            if moved * probe[10, i] < 0.0:
                probe[9, i] += 1.0
            if probe[9, i] > SWINGS:
                pace = RISE / (1.0 + (e[i] / FAR) ** 2) if ta > 0.0 else FALL
                found = min(max(rotor[i] + min(pace * dt, 1.0) * ta / aa, 0.0), largest[i])
                more, rotor[i] = found - rotor[i], found
                # What is explained from now on was never lacking.
                for k in range(3):
                    probe[3 + k, i] -= more * probe[k, i]
                probe[7, i] += more * (more * aa - 2.0 * ta)
                probe[8, i] -= more * aa
        else:
            probe[9, i] = 0.0
        probe[10, i] = moved
