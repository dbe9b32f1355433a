"""What a joint does in a time window in which its reference stands still.

All take the whole run and a window of it, `(from, to)` [s], both ends included.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

REST_ERROR = 1e-3
"""Error of a joint below which it counts as arrived [rad, m]."""
REST_SPEED = 2e-3
"""Speed of a joint below which it counts as still [rad/s, m/s]."""

CALM = 0.5
"""Rest that must be seen to count [s]."""


def swing_in(t: Array, e: Array, window: tuple[float, float]) -> Array:
    """Return how far each joint swings in a window: largest minus least error, (nv,) [rad, m].

    Where the reference rests this is the joint's own swing; the error in place of the position
    keeps joints right that turn on and on.

    Args:
        t: times (N,) [s].
        e: tracking error (N, nv) [rad, m].
        window: a time span in which the reference rests [s].
    """
    rows = e[inside(t, window)]
    return np.asarray(rows.max(axis=0) - rows.min(axis=0))


def arrival_time(
    t: Array,
    e: Array,
    v: Array,
    window: tuple[float, float],
    *,
    error: float = REST_ERROR,
    speed: float = REST_SPEED,
    calm: float = CALM,
) -> float:
    """Return how long after the window's beginning every joint has come to rest for good [s].

    That is the first time from which, until the window's end, `|e_j| ≤ error` and `|v_j| ≤ speed`
    in each joint, counted from the beginning of the window. It is inf if there is none, or if what
    is left of the window is shorter than `calm`: a joint that hunts stands still now and then.

    Args:
        t: times (N,) [s].
        e: tracking error (N, nv) [rad, m].
        v: true velocity (N, nv) [rad/s, m/s].
        window: from the end of the reference's motion to its next one [s].
        error: bound on each joint's error [rad, m].
        speed: bound on each joint's speed [rad/s, m/s].
        calm: shortest rest that counts [s].

    Raises:
        ArgumentError: a bound that is not above 0, or a window without a row.
    """
    checks.finite_number("error", error, above=0.0)
    checks.finite_number("speed", speed, above=0.0)
    chosen = inside(t, window)
    still = (np.abs(e[chosen]) <= error).all(axis=1) & (np.abs(v[chosen]) <= speed).all(axis=1)
    restless = np.flatnonzero(~still)
    if restless.size == 0:
        return 0.0
    if restless[-1] + 1 == len(still):
        return math.inf
    arrived = float(t[chosen][restless[-1] + 1])
    return arrived - window[0] if window[1] - arrived >= calm else math.inf


def overshoot(t: Array, to_go: Array, window: tuple[float, float]) -> Array:
    """Return how far each joint goes beyond the end of a move, (nv,) [rad, m]; 0 if it does not.

    Args:
        t: times (N,) [s].
        to_go: end of the move minus the joint's position (N, nv) [rad, m]; the move's direction is
            its sign at the window's beginning. A joint that has nowhere to go overshoots in either
            direction.
        window: from the beginning of the move to that of the next one [s].
    """
    rows = to_go[inside(t, window)]
    direction = np.sign(rows[0])
    beyond = np.where(direction == 0.0, np.abs(rows), -direction * rows)
    return np.asarray(np.maximum(beyond.max(axis=0), 0.0))


def inside(t: Array, window: tuple[float, float]) -> Array:
    """Return which of the times lie in a window, (N,) bool.

    Raises:
        ArgumentError: none does.
    """
    slack = 1e-9 * (1.0 + abs(window[1]))
    chosen = (t >= window[0] - slack) & (t <= window[1] + slack)
    if not chosen.any():
        message = f"the run holds times from {t[0]:g} to {t[-1]:g} s; give a window inside"
        raise ArgumentError("window", window, message)
    return np.asarray(chosen)
