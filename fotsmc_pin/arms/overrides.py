"""Numbers per joint that replace the file's: limits, friction, damping, armature."""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fotsmc_pin.arms.properties import impossible, read_properties, write_properties
from fotsmc_pin.errors import ArgumentError, UrdfError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms.tree import UrdfTree

PerJoint: TypeAlias = "ArrayLike | Mapping[str, float]"


def apply_overrides(
    tree: UrdfTree, joint_names: Sequence[str], overrides: Mapping[str, PerJoint]
) -> None:
    """Write numbers into the tree.

    Args:
        tree: the arm.
        joint_names: the moving joints in the arm's order, which a vector follows.
        overrides: by property, a scalar for all joints, a vector, or a mapping from joint names
            or patterns.

    Raises:
        ArgumentError: wrong length, unknown joint, or a number out of its range.
    """
    values: dict[str, dict[str, float]] = {joint: {} for joint in joint_names}
    for name, given in overrides.items():
        for joint, value in joint_values(name, given, joint_names).items():
            check_property(name, value)
            values[joint][name] = value
    for joint, changed in values.items():
        write_properties(tree, tree.joints[joint], changed)
        try:
            read_properties(tree, tree.joints[joint])
        except UrdfError as error:
            argument = "upper" if "upper_position_limit" in changed else "lower"
            argument += "_position_limit"
            raise ArgumentError(argument, overrides.get(argument), str(error)) from None


def joint_values(argument: str, given: PerJoint, joint_names: Sequence[str]) -> dict[str, float]:
    """Return the number of each joint that a scalar, a vector or a mapping by joint names."""
    if isinstance(given, Mapping):
        values = {}
        for pattern, value in given.items():
            matches = [joint for joint in joint_names if fnmatchcase(joint, pattern)]
            if not matches:
                known = ", ".join(joint_names)
                raise ArgumentError(argument, pattern, f"no moving joint has this name; {known}")
            values.update(dict.fromkeys(matches, _number(argument, value)))
        return values
    try:
        vector = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArgumentError(argument, given, "give a number, a vector or a mapping") from None
    if vector.ndim == 0:
        vector = np.full(len(joint_names), vector)
    if vector.shape != (len(joint_names),):
        raise ArgumentError(
            argument, given, f"give one number, or {len(joint_names)}: {', '.join(joint_names)}"
        )
    return {joint: float(value) for joint, value in zip(joint_names, vector, strict=True)}


def check_property(name: str, value: float) -> None:
    """Demand a number that the property can have."""
    wanted = impossible(name, value)
    if wanted is not None:
        raise ArgumentError(name, value, f"give {wanted}")


def _number(argument: str, value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ArgumentError(argument, value, "give a number") from None
