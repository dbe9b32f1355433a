"""The arm that moves: the nominal one perturbed, or one from a URDF of its own."""

from __future__ import annotations

from dataclasses import replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.cli.arm_options import ArmOptions


def load_true_arm(source: str, nominal: Arm, options: ArmOptions) -> Arm:
    """Load a second URDF, for the plant, with the joints of the nominal arm.

    Joints are fixed as in the nominal arm, as far as the file still has them: one that `fotsmc
    perturb` wrote has them fixed already. The nominal arm's `--armature` is no part of the plant.

    Raises:
        ArgumentError: the moving joints differ; the message says which.
    """
    free: Sequence[str] = ()
    if options.lock or options.keep:
        everything = replace(options, lock=None, keep=["*"], armature=None, tool_frame=None)
        free = everything.load(source).joint_names
    arm = replace(
        options,
        lock=_still_there(options.lock, free),
        keep=_still_there(options.keep, free),
        armature=None,
    ).load(source)
    _demand_same_joints(source, arm, nominal)
    return arm


def _still_there(patterns: list[str] | None, joints: Sequence[str]) -> list[str] | None:
    if not patterns:
        return None
    return [
        pattern
        for pattern in patterns
        if any(fnmatchcase(joint, pattern.partition("=")[0]) for joint in joints)
    ] or None


def _demand_same_joints(source: str, true: Arm, nominal: Arm) -> None:
    ours, theirs = nominal.joint_names, true.joint_names
    differences = [
        *(f"{name} moves in {nominal.name} only" for name in ours if name not in theirs),
        *(f"{name} moves in {source} only" for name in theirs if name not in ours),
    ]
    if not differences:
        if ours != theirs:
            differences.append(f"their order is {', '.join(ours)} and {', '.join(theirs)}")
        kinds = [
            (name, nominal.tree.joints[name].type, true.tree.joints[name].type) for name in ours
        ]
        differences += [
            f"{name} is {one} in {nominal.name} and {other} in {source}"
            for name, one, other in kinds
            if one != other
        ]
    if differences:
        raise ArgumentError(
            "--true",
            source,
            f"the moving joints differ: {'; '.join(differences)}. --lock and --keep fix joints in "
            "both files",
        )
