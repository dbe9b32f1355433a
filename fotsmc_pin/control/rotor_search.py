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
    from fotsmc_pin.control.robust_rows import State
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array

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
WIDE = 0.5
"""Peak of a swing over the recent RMS acceleration: noise after a transient swings less."""
RISE, FALL = 0.8, 20.0
"""Rates at which missing inertia is made up, and at which surplus is taken away [1/s].

Slowly up: the loop is quiet long before all that is missing is found, and what is found at one pose
(of a payload) is not there at another. Fast down: too much oscillates at the rate of the ticks.
"""
LED, CERTAIN = 5.0, 0.92
"""Rate at which missing inertia is made up while a joint is led home and brakes [1/s], and the
correlation from which on that is done. The friction of a joint that brakes is constant, and no part
of what changes with its acceleration."""
LARGEST_DOUBT = 3.0
"""Rotor that a braking joint may add, over the one that its model has."""
FAR = 0.2
"""Error at which a joint counts as on its way: what its pose there asks for is not learnt [rad]."""


def largest_rotor(arm: Arm) -> Array:
    """Return the most that is ever found at a joint, (nv,) [kg·m²]; infinite without a limit."""
    limit: Array = arm.effort_limit * LARGEST_SHARE
    return limit


def doubtful_rotor(arm: Arm) -> Array:
    """Return how much a braking joint may add, (nv,) [kg·m²]: three times its model's rotor.

    A rotor by rule is right within a factor of four. Where the model has none, what resists a
    braking joint may as well be a payload, whose inertia acts on all joints at once and must not be
    added to one of them.
    """
    doubt: Array = LARGEST_DOUBT * arm.armature
    return doubt


@kernel(is_part=True)
def search_rotor(dt: float, x: Joints, largest: Array, doubt: Array, m: State) -> None:
    """Move the rotor inertias `J` (nv,) [kg·m²] by one tick.

    The torque that the model with `J` leaves unexplained and the acceleration beyond the
    reference's pass the same band-pass. With means over the last quarter of a second, what is
    missing is `⟨τ a⟩ / ⟨a²⟩`, the least-squares estimate; after `SWINGS` of an oscillation,
    each with a peak above half the RMS acceleration (a transient leaves large means behind),

        J̇ = 0.8 ⟨τ a⟩ / ⟨a²⟩ upward, 20 ⟨τ a⟩ / ⟨a²⟩ downward,   0 ≤ J ≤ largest.

    A joint that is led home from far off (`approach`) shows its inertia as it brakes: where the
    correlation is above 0.92, `J` rises at 5 in place of 0.8, up to what its model may lack.

    Dry friction is in quadrature with the acceleration of an oscillation, and gravity changes
    slowly: neither biases the estimate, and too much of either spoils the correlation, so that
    nothing is learnt.

    Args:
        dt: time since the last tick [s].
        x: rows of the joints, for the error.
        largest: bound of `J` (nv,).
        doubt: bound of what a braking joint adds (nv,).
        m: the law's state.
    """
    up = UPPER_BAND * dt / (1.0 + UPPER_BAND * dt)
    down = LOWER_BAND * dt / (1.0 + LOWER_BAND * dt)
    forgetting = FORGETTING * dt / (1.0 + FORGETTING * dt)
    for i in range(x.e.size):
        m.a_1[i] += up * (m.a_e[i] - m.a_1[i])
        m.a_2[i] += up * (m.a_1[i] - m.a_2[i])
        m.a_3[i] += down * (m.a_2[i] - m.a_3[i])
        m.tau_1[i] += up * (m.lacking[i] - m.tau_1[i])
        m.tau_2[i] += up * (m.tau_1[i] - m.tau_2[i])
        m.tau_3[i] += down * (m.tau_2[i] - m.tau_3[i])
        moved, torque = m.a_2[i] - m.a_3[i], m.tau_2[i] - m.tau_3[i]
        m.aa[i] += forgetting * (moved * moved - m.aa[i])
        m.tt[i] += forgetting * (torque * torque - m.tt[i])
        m.ta[i] += forgetting * (torque * moved - m.ta[i])
        aa, tt, ta = m.aa[i], m.tt[i], m.ta[i]
        m.peak[i] = max(m.peak[i], abs(moved))
        turns = moved * m.last_moved[i] < 0.0
        if aa > OSCILLATION**2 and abs(ta) > LIKENESS * math.sqrt(aa * tt):
            if turns:
                m.swings[i] = m.swings[i] + 1.0 if m.peak[i] > WIDE * math.sqrt(aa) else 0.0
            brakes = m.way[i] != 0.0 and x.e_dot[i] * m.a_1[i] < 0.0
            led = brakes and m.J[i] < doubt[i] and ta > CERTAIN * math.sqrt(aa * tt)
            if m.swings[i] > SWINGS or led:
                pace = (LED if led else RISE) / (1.0 + (x.e[i] / FAR) ** 2) if ta > 0.0 else FALL
                found = min(max(m.J[i] + min(pace * dt, 1.0) * ta / aa, 0.0), largest[i])
                more, m.J[i] = found - m.J[i], found
                # What is explained from now on was never lacking.
                m.tau_1[i] -= more * m.a_1[i]
                m.tau_2[i] -= more * m.a_2[i]
                m.tau_3[i] -= more * m.a_3[i]
                m.tt[i] += more * (more * aa - 2.0 * ta)
                m.ta[i] -= more * aa
        else:
            m.swings[i] = 0.0
        if turns:
            m.peak[i] = 0.0
        m.last_moved[i] = moved
