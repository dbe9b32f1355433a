"""Rotor inertia where a file gives none: a rule from the effort limit, and its absence in words.

A geared motor's rotor turns `N` times faster than its joint and is felt there as `I N²`, the
armature. Plain URDF has no tag for it. Motors and gears are sized alike from arm to arm, so the
armature grows with the effort limit; the page "Bring your own URDF" lists published figures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms.properties import read_properties
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.arms.tree import UrdfTree

ROTORS = "rotors"
"""The word that asks for the rule in place of numbers."""
LIMIT_OVER_ARMATURE = 200.0
"""Effort limit over armature [rad/s², m/s²]: the acceleration of a motor that drives itself alone.

Published figures lie between 58 and 1500; see the page "Bring your own URDF".
"""


def rotor_inertias(tree: UrdfTree, joint_names: Sequence[str]) -> dict[str, float]:
    """Return the armature by the rule, `effort limit / 200`, of each joint whose file gives none.

    Raises:
        ArgumentError: such a joint states no effort limit.
    """
    found = {}
    for name in joint_names:
        joint = read_properties(tree, tree.joints[name])
        if joint.armature > 0.0:
            continue
        if not np.isfinite(joint.effort_limit):
            raise ArgumentError(
                "armature",
                ROTORS,
                f"joint {name!r} states no effort limit, from which its rotor inertia would "
                f"follow; give effort_limit={{{name!r}: ...}}, or the armature itself in numbers",
            )
        found[name] = joint.effort_limit / LIMIT_OVER_ARMATURE
    return found


class RotorWarning(UserWarning):
    """An arm's model has joints without rotor inertia, which real geared joints have."""


def warn_of_missing_rotors(arm: Arm) -> None:
    """Warn where `rotor_remark` has something to say.

    Warns:
        RotorWarning: which joints lack a rotor, what that means and what to do.
    """
    remark = rotor_remark(arm)
    if remark is not None:
        warn_user(f"{arm.name}: {remark[0].lower()}{remark[1:]}", RotorWarning)


def rotor_remark(arm: Arm) -> str | None:
    """Return in plain words which joints have no rotor inertia and what that means, or None."""
    bare = [name for name, value in zip(arm.joint_names, arm.armature, strict=True) if value == 0.0]
    if not bare:
        return None
    which = "any joint" if len(bare) == arm.nv else ", ".join(bare)
    return (
        f"No rotor inertia (armature) is given for {which}. A geared motor's rotor often weighs "
        "more at the joint than the links beyond it, at the wrist several times more; without it a "
        "simulated arm is too light and a controller's model too. Give it with armature=..., or "
        'estimate it from the effort limits with armature="rotors".'
    )
