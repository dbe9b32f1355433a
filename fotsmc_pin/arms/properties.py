"""What a URDF says about each joint: limits, friction, damping, armature; and how to change it."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms.tree import Joint, UrdfTree

NOTE = "fotsmc_pin"
"""Tag, below `<robot>` and below `<joint>`, of what URDF has no tag for; others overlook it."""
STRIBECK_VELOCITY = 0.05
"""Speed at which the friction of breakaway fades, where none is given [rad/s, m/s]."""
# Attributes of the tag below a joint, with what stands for "not given".
NOTED = {
    "stiction": 1.0,
    "stribeck_velocity": STRIBECK_VELOCITY,
    "joint_stiffness": math.inf,
    "joint_damping": 0.0,
}

# The parser behind Pinocchio refuses "inf"; a bound beyond any machine replaces it.
UNBOUNDED = 1e300


@dataclass(frozen=True, kw_only=True)
class JointProperties:
    """Numbers of one joint: infinite limits, and a rigid joint, where the file gives none."""

    armature: float
    friction: float
    damping: float
    effort_limit: float
    velocity_limit: float
    lower_position_limit: float
    upper_position_limit: float
    stiction: float
    stribeck_velocity: float
    joint_stiffness: float
    joint_damping: float


def read_properties(tree: UrdfTree, joint: Joint) -> JointProperties:
    """Return what the file says about a moving joint.

    An effort or velocity limit of 0 or inf means "not given", as do equal position limits of 0.

    Raises:
        UrdfError: a number that is none, negative friction, damping, armature or limits, or
            position limits in the wrong order.
    """
    where = f"joint {joint.name!r}"
    limit, dynamics = joint.element.find("limit"), joint.element.find("dynamics")
    lower = tree.number(limit, "lower", 0.0, where)
    upper = tree.number(limit, "upper", 0.0, where)
    if joint.type == "continuous" or lower == upper == 0.0:
        lower, upper = -math.inf, math.inf
    if lower >= upper:
        raise tree.fail(f"{where}: lower limit {lower:g} is not below upper limit {upper:g}")
    found = JointProperties(
        armature=_armature(tree, joint),
        friction=tree.number(dynamics, "friction", 0.0, where),
        damping=tree.number(dynamics, "damping", 0.0, where),
        effort_limit=_given(tree.number(limit, "effort", 0.0, where)),
        velocity_limit=_given(tree.number(limit, "velocity", 0.0, where)),
        lower_position_limit=-math.inf if lower <= -UNBOUNDED else lower,
        upper_position_limit=math.inf if upper >= UNBOUNDED else upper,
        **_noted(tree, joint),
    )
    for name in ("armature", "friction", "damping", "effort_limit", "velocity_limit"):
        value = getattr(found, name)
        if value < 0.0:
            raise tree.fail(f"{where}: {name.replace('_', ' ')} {value:g} is negative")
        if name in ("armature", "friction", "damping") and not math.isfinite(value):
            raise tree.fail(f"{where}: {name} {value:g} is not finite")
    return found


def write_properties(tree: UrdfTree, joint: Joint, values: Mapping[str, float]) -> None:
    """Change properties of a joint in the tree; those not named stay as they are."""
    for name in ("friction", "damping"):
        if name in values:
            _child(joint.element, "dynamics").set(name, repr(float(values[name])))
    for name in ("effort_limit", "velocity_limit"):
        if name in values:
            limit = 0.0 if math.isinf(values[name]) else float(values[name])
            _child(joint.element, "limit").set(name.removesuffix("_limit"), repr(limit))
    if "lower_position_limit" in values or "upper_position_limit" in values:
        _set_position_limits(tree, joint, values)
    for name in NOTED:
        if name in values:
            _note(joint.element, name, float(values[name]))
    if "armature" in values:
        _set_armature(tree.robot, joint.name, float(values["armature"]))


def complete_limits(joint: Joint) -> bool:
    """Give a joint the `<limit effort velocity>` that parsers demand; whether any was missing."""
    limit = _child(joint.element, "limit")
    missing = [name for name in ("effort", "velocity") if limit.get(name) is None]
    for name in ("effort", "velocity"):
        if name in missing or math.isinf(float(limit.get(name, "0"))):
            limit.set(name, "0")
    for name, unbounded in (("lower", -UNBOUNDED), ("upper", UNBOUNDED)):
        if math.isinf(float(limit.get(name, "0"))):
            limit.set(name, repr(unbounded))
    return bool(missing)


def impossible(name: str, value: float) -> str | None:
    """Return what a property can be, where `value` is none of it; None where it is."""
    if name in ("armature", "friction", "damping", "joint_damping"):
        return None if 0.0 <= value < math.inf else "a finite number of at least 0"
    if name == "stiction":
        return None if 1.0 <= value < math.inf else "a finite number of at least 1"
    if name == "stribeck_velocity":
        return None if 0.0 < value < math.inf else "a finite number above 0"
    if name in ("effort_limit", "velocity_limit"):
        return None if value > 0.0 else "a positive number, inf for no limit"
    if name == "joint_stiffness":
        return None if value > 0.0 else "a positive number, inf for a rigid joint"
    return "a number" if math.isnan(value) else None


def _noted(tree: UrdfTree, joint: Joint) -> dict[str, float]:
    """Return what the tag of this library says of a joint."""
    note, found = joint.element.find(NOTE), {}
    for name, not_given in NOTED.items():
        value = found[name] = tree.number(note, name, not_given, f"joint {joint.name!r}")
        wanted = impossible(name, value)
        if wanted is not None:
            words = f"its {name.replace('_', ' ')} {value:g} is not {wanted}"
            raise tree.fail(f"joint {joint.name!r}: {words}")
    return found


def _note(joint: ET.Element, name: str, value: float) -> None:
    """Write a number into the tag of this library, or take it out where it says nothing."""
    note = _child(joint, NOTE)
    if value == NOTED[name]:
        note.attrib.pop(name, None)
        if not note.attrib:
            joint.remove(note)
    else:
        note.set(name, repr(value))


def _set_position_limits(tree: UrdfTree, joint: Joint, values: Mapping[str, float]) -> None:
    """Write both limits, since one of them alone would turn the other's "not given" into 0."""
    now = read_properties(tree, joint)
    lower = values.get("lower_position_limit", now.lower_position_limit)
    upper = values.get("upper_position_limit", now.upper_position_limit)
    limit = _child(joint.element, "limit")
    if math.isinf(lower) and math.isinf(upper):
        limit.attrib.pop("lower", None)
        limit.attrib.pop("upper", None)
    else:
        limit.set("lower", repr(float(max(lower, -UNBOUNDED))))
        limit.set("upper", repr(float(min(upper, UNBOUNDED))))


def _given(limit: float) -> float:
    return math.inf if limit == 0.0 or limit >= UNBOUNDED else limit


def _child(parent: ET.Element, tag: str) -> ET.Element:
    found = parent.find(tag)
    return ET.SubElement(parent, tag) if found is None else found


def _actuators(robot: ET.Element, joint: str) -> list[ET.Element]:
    return [
        actuator
        for transmission in robot.findall("transmission")
        if any(element.get("name") == joint for element in transmission.findall("joint"))
        for actuator in transmission.findall("actuator")
    ]


def _armature(tree: UrdfTree, joint: Joint) -> float:
    """Return rotor inertia times gear ratio squared, from Drake's tags under `<transmission>`."""
    where = f"transmission of joint {joint.name!r}"
    total = 0.0
    for actuator in _actuators(tree.robot, joint.name):
        inertia = tree.number(actuator.find("drake:rotor_inertia"), "value", 0.0, where)
        ratio = tree.number(actuator.find("drake:gear_ratio"), "value", 1.0, where)
        if inertia < 0.0:
            raise tree.fail(f"{where}: rotor inertia {inertia:g} is negative")
        total += inertia * ratio**2
    return total


def _set_armature(robot: ET.Element, joint: str, armature: float) -> None:
    actuators = _actuators(robot, joint)
    if not actuators:
        transmission = ET.SubElement(robot, "transmission", name=f"{joint}_transmission")
        ET.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
        ET.SubElement(transmission, "joint", name=joint)
        actuators = [ET.SubElement(transmission, "actuator", name=f"{joint}_motor")]
    robot.attrib.setdefault("xmlns:drake", "http://drake.mit.edu")
    for number, actuator in enumerate(actuators):
        _child(actuator, "drake:rotor_inertia").set("value", repr(armature if not number else 0.0))
        _child(actuator, "drake:gear_ratio").set("value", "1.0")
