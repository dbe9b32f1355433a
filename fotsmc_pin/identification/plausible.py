"""Whether positions and velocities of a log can be those of the joints that they are said to be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import LogError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

DEGREES = 180.0 / np.pi
WINDOW = 0.05
"""Positions and velocities are compared as means over so long [s], which takes the noise off."""
MOVES = 0.02
"""A joint is looked at if its speed reaches this, RMS [rad/s, m/s]."""
ALIKE, UNLIKE = 0.9, 0.6
"""Correlations of velocity and change of position that are clear, and that are none."""
OFF = 0.25
"""A velocity may be off the change of position by this share; filters and steps do some."""
BEYOND = 0.1
"""Share of a range by which a position may be beyond its limits before it is said."""


def demand_positions(source: str, arm: Arm, x: Array) -> list[str]:
    """Return what is odd about joint positions (T, nv); refuse degrees.

    Raises:
        LogError: positions that can only be degrees.
    """
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    turning = np.array([unit == "rad" for unit in arm.position_units])
    reach = np.abs(x).max(axis=0)
    bound = np.maximum(np.maximum(np.abs(lower), np.abs(upper)), np.pi)
    bound = np.where(np.isfinite(bound), bound, 4.0 * np.pi)
    wild = turning & (reach > 3.0 * bound) & (np.ptp(x, axis=0) > 3.0 * bound / 2.0)
    if wild.any():
        j = int(np.argmax(wild))
        raise LogError(
            f"{source}: {arm.joint_names[j]} goes from {x[:, j].min():.4g} to {x[:, j].max():.4g} "
            f"and its limits are {lower[j]:.4g} and {upper[j]:.4g} rad: these are degrees; "
            "multiply positions and velocities by π/180"
        )
    slack = BEYOND * np.where(np.isfinite(upper - lower), upper - lower, 0.0)
    over = np.maximum(x.max(axis=0) - upper, lower - x.min(axis=0)) > slack
    return [
        f"{arm.joint_names[j]} goes from {x[:, j].min():.4g} to {x[:, j].max():.4g}, beyond its "
        f"limits {lower[j]:.4g} and {upper[j]:.4g}: is it this joint's column, and in "
        f"{arm.position_units[j]}?"
        for j in np.flatnonzero(over)
    ]


def demand_velocities(source: str, arm: Arm, t: Array, x: Array, v: Array) -> None:
    """Refuse velocities (T, nv) that are not the change of the positions.

    Raises:
        LogError: columns that are swapped, a sign that is wrong, degrees, or another factor.
    """
    period = (t[-1] - t[0]) / (len(t) - 1)
    span = max(round(WINDOW / period), 1)
    if len(t) < 4 * span:
        return
    rate = (x[span:] - x[:-span]) / (span * period)
    sums = np.cumsum(np.vstack([np.zeros((1, v.shape[1])), 0.5 * (v[1:] + v[:-1])]), axis=0)
    mean = (sums[span:] - sums[:-span]) / span
    moving = np.sqrt(np.mean(rate**2, axis=0)) > MOVES
    alike = _correlations(mean, rate)
    names = arm.joint_names
    for j in np.flatnonzero(moving):
        if alike[j, j] > ALIKE:
            _demand_factor(
                source, names[j], float(mean[:, j] @ rate[:, j] / (rate[:, j] @ rate[:, j]))
            )
        elif alike[j, j] < -ALIKE:
            raise LogError(
                f"{source}: the velocity of {names[j]} has the opposite sign of the change of its "
                "position; turn one of them round, as the URDF's axis says"
            )
        elif alike[j, j] < UNLIKE:
            k = int(np.argmax(alike[j] * moving))
            if k != j and alike[j, k] > ALIKE:
                raise LogError(
                    f"{source}: the velocity of {names[j]} is the change of the position of "
                    f"{names[k]}: columns are swapped"
                )


def _demand_factor(source: str, joint: str, factor: float) -> None:
    if abs(factor - 1.0) < OFF:
        return
    if abs(factor / DEGREES - 1.0) < OFF:
        what = "is in degrees a second, its position in rad: multiply the velocity by π/180"
    elif abs(factor * DEGREES - 1.0) < OFF:
        what = "is in rad/s, its position in degrees: multiply the position by π/180"
    else:
        what = f"is {factor:.3g} times the change of its position: check units and stamps"
    raise LogError(f"{source}: the velocity of {joint} {what}")


def _correlations(a: Array, b: Array) -> Array:
    """Return the correlation of each column of `a` with each of `b`."""
    sizes = np.outer(np.linalg.norm(a, axis=0), np.linalg.norm(b, axis=0))
    table: Array = (a.T @ b) / np.maximum(sizes, 1e-300)
    return table
