"""The arms of a scenario: the nominal one, and the true one that differs from it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms import perturb
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.arms.markup import parse_urdf, urdf_text
from fotsmc_pin.arms.overrides import apply_overrides
from fotsmc_pin.arms.rotors import LIMIT_OVER_ARMATURE
from fotsmc_pin.arms.tree import UrdfTree

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

MASS_SCALE = 1.3
FRICTION = 0.5
"""Coulomb [N·m] and viscous [N·m·s/rad] friction of a joint of at least `FULL_EFFORT`."""
FULL_EFFORT = 20.0
"""Effort limit below which a joint's friction is scaled down in proportion [N·m]."""
SPRING_DAMPING = 0.02
"""Damping of an elastic joint over the critical damping of its motor on its spring."""


def with_rotors(arm: Arm) -> Arm:
    """Return the nominal arm with rotors by rule, as `load_arm(..., armature="rotors")` loads it.

    Where the arm has an armature, that stays; elsewhere it is `drive_size` / 200.
    """
    bare = arm.armature == 0.0
    if not bare.any():
        return arm
    sizes = drive_size(arm)
    rotors = {
        name: float(size) / LIMIT_OVER_ARMATURE
        for name, size, lacks in zip(arm.joint_names, sizes, bare, strict=True)
        if lacks
    }
    tree = UrdfTree(parse_urdf(arm.urdf, arm.name), arm.name)
    apply_overrides(tree, arm.joint_names, {"armature": rotors})
    return replace(arm, urdf=urdf_text(tree.robot))


def true_armature(nominal: Arm, divisor: float | Array) -> Array:
    """Return rotors of effort limit / `divisor` beside those of `with_rotors`, (nv,) [kg·m², kg].

    Where the arm's file gives an armature, that stands for effort limit / 200: what counts is the
    ratio of the true rotors to those that the nominal arm has.
    """
    return np.asarray(nominal.armature * LIMIT_OVER_ARMATURE / divisor)


def joint_friction(arm: Arm) -> list[float]:
    """Return the Coulomb and viscous friction of each joint, (nv,)."""
    friction: list[float] = (FRICTION * np.minimum(1.0, arm.effort_limit / FULL_EFFORT)).tolist()
    return friction


def stress_plant(
    arm: Arm,
    *,
    payload: float,
    mass_scale: float = MASS_SCALE,
    armature: Array | None = None,
    stiction: float | None = None,
    stribeck_velocity: float | None = None,
    stiffness: float | None = None,
    friction: bool = True,
) -> Arm:
    """Return the true arm of a scenario.

    Args:
        arm: the arm that it is made from.
        payload: mass at the tool [kg].
        mass_scale: factor on the mass of each link.
        armature: the true rotors (nv,) [kg·m², kg]; None for the arm's own.
        stiction: friction at breakaway over Coulomb friction; None for 1.
        stribeck_velocity: speed of its fall [rad/s, m/s].
        stiffness: of the joints' springs over the effort limit [1/rad, 1/m]; None for rigid ones.
        friction: False for an arm without any.
    """
    rubbing = joint_friction(arm) if friction else 0.0
    more: dict[str, Any] = {}
    if armature is not None:
        more["armature"] = armature
    if stiction is not None:
        more |= {"stiction": stiction, "stribeck_velocity": stribeck_velocity}
    if stiffness is not None:
        springs = stiffness * drive_size(arm)
        rotors = arm.armature if armature is None else armature
        more["joint_stiffness"] = springs
        more["joint_damping"] = 2.0 * SPRING_DAMPING * np.sqrt(springs * rotors)
    return perturb(
        arm, mass_scale=mass_scale, payload=payload, friction=rubbing, damping=rubbing, **more
    )
