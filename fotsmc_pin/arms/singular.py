"""Joints that move no inertia, which no dynamics can accelerate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.errors import UrdfError

if TYPE_CHECKING:
    from fotsmc_pin.arms.arm import Arm

CONFIGURATIONS = 5
NOTHING = 1e-13
"""Share of the mass matrix' trace, or of a unit eigenvalue, that is rounding and no inertia."""


def no_inertia(arm: Arm, joint: str) -> UrdfError:
    """Return the error that names a joint without inertia and the remedy."""
    unit = arm.position_units[arm.joint_names.index(joint)]
    what = "mass" if unit == "m" else "inertia about its axis"
    return UrdfError(
        f"{arm.name}: joint {joint!r} moves no {what} of its own, so that no effort gives it a "
        f"finite acceleration; give what it carries an inertia in the file, or load the arm with "
        f'armature={{{joint!r}: ...}} or armature="rotors", or lock the joint'
    )


def joint_without_inertia(arm: Arm) -> str | None:
    """Return the joint that makes the mass matrix singular wherever the arm is, None for none.

    It is one whose diagonal entry is zero, else the one that moves most in the direction in which
    the arm shows no inertia.
    """
    rng = np.random.default_rng(0)
    places = [arm.neutral, *(arm.random_configuration(rng) for _ in range(CONFIGURATIONS - 1))]
    data = arm.model.createData()
    masses = [np.array(pin.crba(arm.model, data, q)) for q in places]
    whole = max(float(np.trace(mass)) for mass in masses) or 1.0
    largest = np.max([np.diag(mass) / whole for mass in masses], axis=0)
    if largest.min() <= NOTHING:
        return arm.joint_names[int(largest.argmin())]
    directions = []
    for mass in masses:
        scale = np.sqrt(np.diag(mass))
        values, vectors = np.linalg.eigh(mass / np.outer(scale, scale))
        if values[0] > NOTHING:
            return None
        directions.append(np.abs(vectors[:, 0]))
    # Of joints that cancel each other's inertia the last one is the likelier mistake.
    share = np.mean(directions, axis=0)
    return arm.joint_names[int(np.flatnonzero(share > 0.99 * share.max())[-1])]
