"""Which joints stay free: `lock`, `keep`, and the grippers and mimic joints locked by default."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.inertia import words
from fotsmc_pin.arms.properties import NOTE
from fotsmc_pin.checks import finite_number
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms.tree import Joint, UrdfTree

Patterns: TypeAlias = "str | Iterable[str]"
GRIPPER, MIMIC = "gripper", "mimic joint"
GRIPPER_PATTERNS = ("*gripper*", "*finger*", "*knuckle*", "*jaw*", "*claw*")


@dataclass(frozen=True, kw_only=True)
class Lock:
    """A joint to be fixed.

    Attributes:
        joint: the joint.
        position: where [rad or m].
        reason: why, in plain words.
        is_of_hand: whether it moves a finger and not the arm.
    """

    joint: Joint
    position: float
    reason: str
    is_of_hand: bool

    def __str__(self) -> str:
        """What was done, in plain words."""
        unit = "m" if self.joint.type == "prismatic" else "rad"
        return f"locked {self.joint.name} at {self.position:g} {unit} ({self.reason})"


def choose_locks(
    tree: UrdfTree, lock: Patterns | Mapping[str, float] | None, keep: Patterns | None
) -> tuple[Lock, ...]:
    """Return the joints to fix.

    Args:
        tree: the arm.
        lock: names or patterns (`finger_*`) of joints to fix at zero or, where zero is outside
            the limits, at the nearest limit; or a mapping from them to positions [rad or m].
        keep: names or patterns of the joints that stay free; all others are fixed. Without it,
            mimic joints and grippers beyond the arm's last joint are fixed too.

    Raises:
        ArgumentError: a name or pattern that no moving joint has.
    """
    joints = tree.moving_joints
    asked = _positions(lock)
    _demand_matches("lock", asked, joints)
    kept = None if keep is None else _words("keep", keep)
    if kept is not None:
        _demand_matches("keep", kept, joints)
    of_hand = _grippers_and_mimics(tree)
    by_default = of_hand if kept is None else {}
    reasons: dict[str, str] = {}
    positions: dict[str, float] = {}
    for joint in joints:
        name = joint.name
        pattern = next((word for word in asked if fnmatchcase(name, word)), None)
        if pattern is not None:
            reasons[name] = "as asked"
        elif kept is not None and not any(fnmatchcase(name, word) for word in kept):
            reasons[name] = "not among the joints to keep"
        elif name in by_default:
            reasons[name] = by_default[name]
        else:
            continue
        given = None if pattern is None else asked[pattern]
        positions[name] = _rest_position(tree, joint) if given is None else given
    _follow_mimicked(tree, positions, asked)
    return tuple(
        Lock(
            joint=tree.joints[name],
            position=positions[name],
            reason=reason,
            is_of_hand=name in of_hand,
        )
        for name, reason in reasons.items()
    )


def apply_locks(locks: Sequence[Lock], tree: UrdfTree) -> None:
    """Turn joints of the tree into fixed ones at their positions."""
    for lock in locks:
        element = lock.joint.element
        if lock.position != 0.0:
            _move_origin(tree, lock)
        element.set("type", "fixed")
        for tag in ("mimic", "limit", "dynamics", "safety_controller", "calibration", NOTE):
            for child in element.findall(tag):
                element.remove(child)
        _disconnect_motor(tree, lock.joint.name)


def _disconnect_motor(tree: UrdfTree, name: str) -> None:
    """Take a joint out of its transmission, which goes when it drives no other."""
    for transmission in tree.robot.findall("transmission"):
        driven = transmission.findall("joint")
        for part in driven:
            if part.get("name") != name:
                continue
            transmission.remove(part)
            if len(driven) == 1:
                tree.robot.remove(transmission)


def _grippers_and_mimics(tree: UrdfTree) -> dict[str, str]:
    """Joints locked by default. A hand without an arm keeps its fingers."""
    found = {}
    for joint in tree.moving_joints:
        before = [other for other in tree.chain(joint.parent) if other.moves]
        if joint.element.find("mimic") is not None:
            found[joint.name] = MIMIC
        elif _is_gripper(joint) and any(not _is_gripper(other) for other in before):
            found[joint.name] = GRIPPER
    return found


def _is_gripper(joint: Joint) -> bool:
    return any(fnmatchcase(joint.name.lower(), pattern) for pattern in GRIPPER_PATTERNS)


def _rest_position(tree: UrdfTree, joint: Joint) -> float:
    """Zero, or the limit nearest to it."""
    limit = joint.element.find("limit")
    lower = tree.number(limit, "lower", 0.0, joint.name)
    upper = tree.number(limit, "upper", 0.0, joint.name)
    return 0.0 if joint.type == "continuous" or lower >= upper else min(max(0.0, lower), upper)


def _follow_mimicked(
    tree: UrdfTree, positions: dict[str, float], asked: Mapping[str, float | None]
) -> None:
    """Put locked mimic joints where the joint that they copy is locked."""
    for name in positions:
        mimic = tree.joints[name].element.find("mimic")
        if mimic is None or any(
            value is not None and fnmatchcase(name, pattern) for pattern, value in asked.items()
        ):
            continue
        leader = mimic.get("joint")
        if leader in positions and leader != name:
            where = f"joint {name!r}"
            multiplier = tree.number(mimic, "multiplier", 1.0, where)
            positions[name] = multiplier * positions[leader] + tree.number(
                mimic, "offset", 0.0, where
            )


def _move_origin(tree: UrdfTree, lock: Lock) -> None:
    """Move the joint's frame by its locked position: `T_fixed = T_origin T_joint(q)`."""
    element, where = lock.joint.element, f"joint {lock.joint.name!r}"
    origin = element.find("origin")
    xyz = np.array(tree.numbers(origin, "xyz", (0.0, 0.0, 0.0), where))
    rpy = np.array(tree.numbers(origin, "rpy", (0.0, 0.0, 0.0), where))
    axis = np.array(tree.numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0), where))
    axis /= np.linalg.norm(axis)
    placement = pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz)
    if lock.joint.type == "prismatic":
        motion = pin.SE3(np.eye(3), lock.position * axis)
    else:
        motion = pin.SE3(pin.exp3(lock.position * axis), np.zeros(3))
    fixed = placement * motion
    if origin is None:
        origin = element.makeelement("origin", {})
        element.insert(0, origin)
    origin.set("xyz", words(fixed.translation))
    origin.set("rpy", words(pin.rpy.matrixToRpy(fixed.rotation)))


def _words(argument: str, patterns: Patterns) -> tuple[str, ...]:
    several = (patterns,) if isinstance(patterns, str) else patterns
    found = tuple(several) if isinstance(several, Iterable) else (several,)
    if not all(isinstance(word, str) for word in found):
        raise ArgumentError(argument, patterns, "give joint names or patterns as text")
    return found


def _positions(lock: Patterns | Mapping[str, float] | None) -> dict[str, float | None]:
    if lock is None:
        return {}
    if isinstance(lock, Mapping):
        return {name: finite_number(f"lock[{name!r}]", value) for name, value in lock.items()}
    return dict.fromkeys(_words("lock", lock))


def _demand_matches(argument: str, patterns: Iterable[str], joints: Sequence[Joint]) -> None:
    for pattern in patterns:
        if not any(fnmatchcase(joint.name, pattern) for joint in joints):
            known = ", ".join(joint.name for joint in joints)
            raise ArgumentError(argument, pattern, f"no moving joint has this name; known: {known}")
