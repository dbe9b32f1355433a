"""What holding still asks of a law that integrates: rest of the reference, and joints that stick.

A law with two integrals in a row hunts against dry friction for ever; one with a single integral
does not, and needs long to arrive. `follow_rest` says how much a joint's reference rests, by which
the second integral is faded out. `watch_standstill` finds the joints that dry friction holds, on
which the single integral may pause once the error is small, and the torque stay as it is: noise
and what the neighbours ask would walk a joint that stands near the limit of its friction.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.control.robust_rows import State
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array

SLOW, GENTLE = 0.02, 0.2
"""Speed [rad/s] and acceleration [rad/s²] below which a reference counts as at rest."""
REST_RATE = 30.0
"""Rate at which rest is believed, and doubted [1/s]."""
WATCHING, SMOOTHING = 100.0, 20.0
"""Bandwidths in which position and torque are watched [rad/s]."""
MOVED = 3e-5
"""Travel after which a joint has moved [rad]: above an encoder's noise once that is smoothed."""
PUSHED = 0.3
"""Change of the torque over the inertia that moves a joint which nothing holds [rad/s²].

In `1 / SMOOTHING` seconds it moves a free joint of ten times the nominal inertia by 37 µrad.
"""
NEAR = 1.5e-4
"""Error at which a joint that sticks is left in peace [rad]."""
HUNTING, FARTHEST = 8, 2e-3
"""Slips past the goal that count as hunting, and the largest error that may end it [rad]."""
NEGLIGIBLE = 1e-5
"""Error beyond which a second integral does no good at rest [rad]."""


@kernel(is_part=True)
def follow_rest(dt: float, x: Joints, rest: Array) -> None:
    """Move `ρ` (nv,) by one tick: 1 where the reference of a joint rests, 0 where it moves.

    `ρ` follows `exp(-(v_d / 0.02)² - (a_d / 0.2)²)` at the rate 30/s.
    """
    share = REST_RATE * dt / (1.0 + REST_RATE * dt)
    for i in range(rest.size):
        still = math.exp(-((x.v_d[i] / SLOW) ** 2) - (x.a_d[i] / GENTLE) ** 2)
        rest[i] += share * (still - rest[i])


@kernel(is_part=True)
def watch_standstill(dt: float, x: Joints, push: Array, inertia: Array, m: State) -> None:
    """Find the joints that stick, those held near their goal, and those exact all along (`kept`).

    A joint sticks where its torque changes by more than `PUSHED` and it has not moved by `MOVED`:
    what nothing holds would have moved. It counts as held where it is near its goal besides. (A
    joint that is exact all along may stand still because a disturbance is being compensated.) A
    joint that slips past its goal and sticks on the other side eight times, and so would hunt for
    ever (friction that falls with speed does that), is left at the smaller of two errors until its
    reference moves.

    Args:
        dt: time since the last tick [s].
        x: rows of the joints, for the error.
        push: torque beside `C0 v + G0` (nv,) [N·m].
        inertia: the joint's own, with what is added (nv,) [kg·m²].
        m: the law's state.
    """
    watching = WATCHING * dt / (1.0 + WATCHING * dt)
    smoothing = SMOOTHING * dt / (1.0 + SMOOTHING * dt)
    for i in range(push.size):
        m.smooth_e[i] += watching * (x.e[i] - m.smooth_e[i])
        m.smooth_u[i] += smoothing * (push[i] - m.smooth_u[i])
        if m.rest[i] < 0.5:
            m.stuck_e[i] = m.slips[i] = m.allowed[i] = 0.0
            m.kept[i] = 1.0
        elif abs(x.e[i]) > NEGLIGIBLE:
            m.kept[i] = 0.0
        if m.rest[i] < 0.5 or abs(m.smooth_e[i] - m.last_e[i]) > MOVED:
            m.last_e[i], m.last_u[i] = m.smooth_e[i], m.smooth_u[i]
            m.stuck[i] = m.held[i] = 0.0
        elif (
            m.kept[i] + m.held[i] == 0.0 and abs(m.smooth_u[i] - m.last_u[i]) > PUSHED * inertia[i]
        ):
            m.stuck[i] = 1.0
            error, before = m.smooth_e[i], m.stuck_e[i]
            if error * before < 0.0:
                m.slips[i] += 1.0
                if m.slips[i] >= HUNTING:
                    m.allowed[i] = min(1.1 * min(abs(error), abs(before)), FARTHEST)
            m.stuck_e[i], m.last_u[i] = error, m.smooth_u[i]
            if abs(error) < max(NEAR, m.allowed[i]):
                m.held[i] = 1.0
