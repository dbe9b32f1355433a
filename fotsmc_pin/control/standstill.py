"""What holding still asks of a law that integrates: rest of the reference, and joints that stick.

A law with two integrals in a row hunts against dry friction for ever; one with a single integral
does not, and needs long to arrive. `follow_rest` says how much a joint's reference rests, by which
the second integral is faded out. `watch_standstill` finds the joints that dry friction holds, on
which the single integral may pause once the error is small.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.control.gains import Array

SLOW, GENTLE = 0.02, 0.2
"""Speed [rad/s] and acceleration [rad/s²] below which a reference counts as at rest."""
REST_RATE = 10.0
"""Rate at which rest is believed, and doubted [1/s]."""
SMOOTHING = 20.0
"""Bandwidth in which position and command are watched [rad/s]."""
MOVED = 3e-5
"""Travel after which a joint has moved [rad]: above an encoder's noise once that is smoothed."""
PUSHED = 0.5
"""Change of the commanded acceleration that moves a joint which nothing holds [rad/s²].

In `1 / SMOOTHING` seconds it moves a free joint of ten times the nominal inertia by 60 µrad.
"""
NEAR = 1.5e-4
"""Error at which a joint that sticks is left in peace [rad]."""
HUNTING, FARTHEST = 8, 2e-3
"""Slips past the goal that count as hunting, and the largest error that may end it [rad]."""
NEGLIGIBLE = 1e-5
"""Error beyond which a second integral does no good at rest [rad]."""


@kernel
def follow_rest(dt: float, v_d: Array, a_d: Array, rest: Array) -> None:
    """Move `ρ` (nv,) by one tick: 1 where the reference of a joint rests, 0 where it moves.

    `ρ` follows `exp(-(v_d / 0.02)² - (a_d / 0.2)²)` at the rate 10/s.
    """
    share = REST_RATE * dt / (1.0 + REST_RATE * dt)
    for i in range(rest.size):
        still = math.exp(-((v_d[i] / SLOW) ** 2) - (a_d[i] / GENTLE) ** 2)
        rest[i] += share * (still - rest[i])


@kernel
def watch_standstill(dt: float, e: Array, u: Array, rest: Array, watch: Array) -> None:
    """Find the joints that stick, and say how far each may be off.

    A joint sticks while the command changes by more than `PUSHED` and it has not moved by `MOVED`:
    what nothing holds would have moved. A joint that slips past its goal and sticks on the other
    side eight times, and so would hunt for ever (friction that falls with speed does that), is left
    at the smaller of two errors until its reference moves.

    Args:
        dt: time since the last tick [s].
        e: tracking error (nv,).
        u: commanded acceleration, with all that is commanded as torque (nv,).
        rest: `ρ` of `follow_rest` (nv,).
        watch: (9, nv), overwritten. Rows: smoothed error and command, both when the joint last
            moved, error at which it last stuck, slips past the goal, allowed error beyond `NEAR`;
            and the results: 1 where the error has been negligible ever since the reference came to
            rest, and 1 where the joint sticks near enough to its goal, else 0.
    """
    smooth_e, smooth_u, last_e, last_u, stuck_e, slips, allowed, kept, held = (
        watch[0], watch[1], watch[2], watch[3], watch[4], watch[5], watch[6], watch[7], watch[8],
    )  # fmt: skip
    share = SMOOTHING * dt / (1.0 + SMOOTHING * dt)
    for i in range(e.size):
        smooth_e[i] += share * (e[i] - smooth_e[i])
        smooth_u[i] += share * (u[i] - smooth_u[i])
        if rest[i] < 0.5:
            stuck_e[i] = slips[i] = allowed[i] = 0.0
            kept[i] = 1.0
        elif abs(e[i]) > NEGLIGIBLE:
            kept[i] = 0.0
        if rest[i] < 0.5 or abs(smooth_e[i] - last_e[i]) > MOVED:
            last_e[i], last_u[i], held[i] = smooth_e[i], smooth_u[i], 0.0
        elif held[i] == 0.0 and abs(smooth_u[i] - last_u[i]) > PUSHED:
            error, before = smooth_e[i], stuck_e[i]
            if error * before < 0.0:
                slips[i] += 1.0
                if slips[i] >= HUNTING:
                    allowed[i] = min(1.1 * min(abs(error), abs(before)), FARTHEST)
            stuck_e[i], last_u[i] = error, smooth_u[i]
            if abs(error) < max(NEAR, allowed[i]):
                held[i] = 1.0
