"""How an arm comes to rest: how far it still swings, and after what time it no longer does."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array

STILL = 1e-9
"""Speed of the reference below which it rests [rad/s, m/s]."""
REST_SWING = 1.5e-4
"""A joint that swings by no more than this is at rest [rad, m]."""
LEAST_REST = 0.5
"""Time for which rest has to be seen before it counts [s]."""


def reference_stop(rec: Recording) -> float | None:
    """Return when the reference came to rest for good [s]; None if it moves to the end."""
    moving = np.flatnonzero(np.abs(rec.v_d).max(axis=1) > STILL)
    if moving.size == 0:
        return float(rec.t[0])
    last = moving[-1] + 1
    return float(rec.t[last]) if last < len(rec.t) else None


def swings(rec: Recording) -> Array:
    """Return by how much each joint swings (nv,) [rad, m].

    It is `max e_j - min e_j`, of the tracking error of joint `j`, over the last half of the time
    for which the reference rests: there it is the swing of the joint's position. Where the
    reference moves to the end, the last half of the run stands in.
    """
    start = reference_stop(rec)
    begin = float(rec.t[0]) if start is None else start
    late = rec.e[rec.t >= begin + 0.5 * (rec.t[-1] - begin)]
    swing: Array = late.max(axis=0) - late.min(axis=0)
    return swing


def time_to_rest(rec: Recording) -> float:
    """Return how long after the reference's last motion the arm comes to rest [s].

    It is the time from that stop to the first row from which on no joint swings by more than
    0.15 mrad (0.15 mm for one that slides) until the end of the run; inf where there is none with
    at least half a second left to see it, or where the reference moves to the end.
    """
    start = reference_stop(rec)
    if start is None:
        return float("inf")
    ahead = rec.e[::-1]
    swing = np.maximum.accumulate(ahead, axis=0) - np.minimum.accumulate(ahead, axis=0)
    quiet = (swing.max(axis=1) <= REST_SWING)[::-1] & (rec.t >= start)
    quiet &= rec.t <= rec.t[-1] - LEAST_REST
    return float(rec.t[np.argmax(quiet)] - start) if quiet.any() else float("inf")
