"""Errors where they matter: at the tool."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array


def tool_errors(rec: Recording, *, samples: int = 2000) -> Array:
    """Return how far the tool is from where its reference is, over the last half of a run [m].

    Args:
        rec: the run.
        samples: at most about so many rows, evenly spread, are looked at.

    Returns:
        Distances between the origins of the tool frame at `q` and at `q_d`, (n,) [m].
    """
    rows = np.flatnonzero(rec.t >= 0.5 * (rec.t[0] + rec.t[-1]))
    rows = rows[:: max(1, len(rows) // samples)]
    pose = rec.arm.tool_pose
    return np.array(
        [
            np.linalg.norm(pose(rec.q[k]).translation - pose(rec.q_d[k]).translation)
            for k in rows.tolist()
        ]
    )
