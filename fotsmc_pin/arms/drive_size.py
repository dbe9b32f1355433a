"""How large a joint's drive is, also where the arm's file does not say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.types import Array

HARDEST = 10.0
"""Acceleration that the drive of a joint without an effort limit is made for [rad/s², m/s²]."""
SAMPLES = 200


def drive_size(arm: Arm) -> Array:
    """Return the effort that each joint's drive is made for (nv,) [N·m, N].

    It is the effort limit. A joint that states none is taken to have a drive for twice the largest
    `|G_j| + 10 rad/s² · M_jj` of 200 random configurations, always the same ones.
    """
    limits = arm.effort_limit
    if np.isfinite(limits).all():
        return limits
    rng = np.random.default_rng(0)
    needed = np.zeros(arm.nv)
    for _ in range(SAMPLES):
        q = arm.random_configuration(rng)
        own = np.abs(arm.gravity(q)) + HARDEST * np.diag(arm.mass_matrix(q))
        needed = np.maximum(needed, 2.0 * own)
    return np.where(np.isfinite(limits), limits, needed)
