"""`available_braking`: the deceleration that an arm's torque limits leave to all joints at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

STATES = 500
COMMON = 95.0
"""Percentage of the random states in which the deceleration is available."""
QUICKEST = 0.1
"""No joint is trusted to stop from full speed in less than this [s]."""
UNLIMITED_SPEED = 3.0
"""Speed of a joint without a limit in the random states [rad/s, m/s]."""


def available_braking(arm: Arm, velocity: Array, torque_share: float) -> Array:
    """Return a deceleration `β` (nv,) [rad/s², m/s²] that all joints can have at once.

    In a state with the torque `h = C v + G` a joint has `share τ_max - |h|` left, of which
    `Σ_j |M_ij| β_j` is needed where all joints brake at their worst. `β` has the shape of what is
    left over the row sums of `|M|`, each at its 95th percentile over random states, times the
    largest factor that suffices in 95 of 100 of them.

    Args:
        arm: the nominal arm.
        velocity: largest speed of each joint (nv,).
        torque_share: share of the torque limits that is counted on.

    Raises:
        ArgumentError: the torque limits hardly carry the arm, or an arm without torque limits.
    """
    rng = np.random.default_rng(0)
    fastest = np.where(np.isfinite(velocity), velocity, UNLIMITED_SPEED)
    quickest = fastest / QUICKEST
    if not np.isfinite(arm.effort_limit).all():
        return quickest
    inertia = np.empty((STATES, arm.nv, arm.nv))
    load = np.empty((STATES, arm.nv))
    at_rest = np.zeros(arm.nv)
    for k in range(STATES):
        q, v = arm.random_configuration(rng), rng.uniform(-1.0, 1.0, arm.nv) * fastest
        inertia[k], load[k] = (
            np.abs(arm.mass_matrix(q)),
            np.abs(arm.inverse_dynamics(q, v, at_rest)),
        )
    left = torque_share * arm.effort_limit - np.percentile(load, COMMON, axis=0)
    if (left <= 0.0).any():
        joint = int(np.argmin(left / arm.effort_limit))
        raise ArgumentError(
            "braking",
            None,
            f"{arm.joint_names[joint]} needs its torque of {arm.effort_limit[joint]:g} "
            f"{arm.effort_units[joint]} to carry the arm, and has none to brake with; if the limit "
            "is right, say what deceleration it has",
        )
    shape = np.minimum(left / np.percentile(inertia.sum(axis=2), COMMON, axis=0), quickest)
    factors = (torque_share * arm.effort_limit - load) / (inertia @ shape)
    factor = float(np.percentile(factors.min(axis=1), 100.0 - COMMON))
    braking: Array = np.minimum(max(factor, 0.1) * shape, quickest)
    return braking
