"""`perturb`: the true plant, an arm whose inertias and friction differ from the model's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np

from fotsmc_pin.arms.demand import demand_arm
from fotsmc_pin.arms.inertia import read_inertia, write_inertia
from fotsmc_pin.arms.markup import parse_urdf, urdf_text
from fotsmc_pin.arms.overrides import PerJoint, check_property, joint_values
from fotsmc_pin.arms.payload import Payload, attach
from fotsmc_pin.arms.properties import write_properties
from fotsmc_pin.arms.random_numbers import Number, PerLink, RandomNumbers, Uniform, spread
from fotsmc_pin.arms.tree import UrdfTree
from fotsmc_pin.checks import finite_number, finite_vector
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.arms.inertia import LinkInertia

Shift: TypeAlias = "Number | ArrayLike"


def perturb(
    arm: Arm,
    *,
    mass_scale: PerLink = 1.0,
    inertia_scale: PerLink = 1.0,
    com_shift: Shift | Mapping[str, Shift] = 0.0,
    payload: Number | Payload | Sequence[Payload] = 0.0,
    friction: PerJoint | PerLink | None = None,
    damping: PerJoint | PerLink | None = None,
    armature: PerJoint | PerLink | None = None,
    stiction: PerJoint | PerLink | None = None,
    stribeck_velocity: PerJoint | PerLink | None = None,
    joint_stiffness: PerJoint | PerLink | None = None,
    joint_damping: PerJoint | PerLink | None = None,
    seed: int | None = None,
    name: str | None = None,
) -> Arm:
    """Return a changed copy of an arm: the plant that its controller does not know exactly.

    Wherever a number stands, `Uniform(low, high)` draws one for each link or joint from `seed`;
    one seed always draws the same arm. A mapping from names or patterns
    (`{"*_link7": 1.5}`) changes only what it names.

    The inertias of the result are physically possible: where the original's violate the triangle
    inequality, they are raised to the nearest ones that satisfy it, and `Arm.changes` says so.
    `Arm.write_urdf` writes the result as a URDF of its own.

    Args:
        arm: the arm to change; it stays as it is.
        mass_scale: factor on mass and inertia of the links: the density.
        inertia_scale: factor on the rotational inertia about the centre of mass.
        com_shift: shift of the centres of mass [m]: a vector (3,) in the link's axes, or a length
            in a direction drawn from `seed`.
        payload: mass of a steel ball at the tool frame [kg], a `Payload`, or several.
        friction: Coulomb friction in place of the arm's, by joint [N·m or N].
        damping: viscous friction in place of the arm's, by joint [N·m·s/rad or N·s/m].
        armature: motor inertia in place of the arm's, by joint [kg·m² or kg].
        stiction: friction at breakaway over Coulomb friction, at least 1, by joint. From rest on,
            friction falls along Stribeck's curve
            `friction · (1 + (stiction - 1) exp(-(v / stribeck_velocity)²))`.
        stribeck_velocity: speed of that fall, by joint [rad/s or m/s]; 0.05 where not given.
        joint_stiffness: of the spring between motor and link, by joint [N·m/rad or N/m]; inf for a
            rigid joint. The motor's inertia is the joint's armature, and friction acts on the motor
            (Spong's model).
        joint_damping: of that spring, by joint [N·m·s/rad or N·s/m].
        seed: where draws come from; needed when anything is drawn.
        name: what to call the result; by default the arm's name and "_perturbed".

    Returns:
        The changed arm; its `changes` list what was done, seed included.

    Raises:
        ArgumentError: an unknown link or joint, a number out of its range, a missing seed, or an
            elastic joint whose motor has no inertia.

    Source: Spong, Journal of Dynamic Systems, Measurement, and Control, 1987 (elastic joints).
    """
    demand_arm(arm)
    tree = UrdfTree(parse_urdf(arm.urdf, arm.name), arm.name)
    random = RandomNumbers(seed)
    changes = [
        *_scale_masses(tree, random, mass_scale),
        *_scale_inertias(tree, random, inertia_scale),
        *_shift_centres(tree, random, com_shift),
        *_repair(tree),
        *_attach_payloads(tree, random, payload, arm.tool_frame),
    ]
    per_joint = {
        "friction": friction,
        "damping": damping,
        "armature": armature,
        "stiction": stiction,
        "stribeck_velocity": stribeck_velocity,
        "joint_stiffness": joint_stiffness,
        "joint_damping": joint_damping,
    }
    for what, given in per_joint.items():
        if given is not None:
            changes += _set_per_joint(tree, random, what, given, arm.joint_names)
    if random.used:
        changes.append(f"drawn from seed {random.seed}")
    all_changes = (*arm.changes, *changes)
    comment = "\n".join([f"Changes to {arm.name}:", *(f"  {change}" for change in all_changes)])
    changed = replace(
        arm,
        urdf=urdf_text(tree.robot, comment if all_changes else ""),
        name=name or f"{arm.name}_perturbed",
        changes=all_changes,
    )
    demand_motors(changed)
    return changed


def demand_motors(arm: Arm) -> None:
    """Refuse an elastic joint whose motor has no inertia.

    Raises:
        ArgumentError: naming the joint and the remedy.
    """
    for name, stiffness, rotor in zip(
        arm.joint_names, arm.joint_stiffness, arm.armature, strict=True
    ):
        if np.isfinite(stiffness) and rotor == 0.0:
            raise ArgumentError(
                "joint_stiffness",
                float(stiffness),
                f"joint {name!r} has no armature, which is the inertia of the motor behind the "
                f'spring; give armature=... here, or armature="rotors" to load_arm',
            )


def moving_links(tree: UrdfTree) -> list[str]:
    """Return the links with mass that some joint moves, in the order of the file."""
    moved = {name for joint in tree.moving_joints for name in tree.rigid_body(joint.child)}
    return [name for name in tree.links if name in moved and _mass(tree, name) > 0.0]


def _mass(tree: UrdfTree, link: str) -> float:
    found = read_inertia(tree, link)
    return 0.0 if found is None else found.mass


def _inertia(tree: UrdfTree, link: str) -> LinkInertia:
    found = read_inertia(tree, link)
    if found is None:
        raise KeyError(link)
    return found


def _scale_masses(tree: UrdfTree, random: RandomNumbers, given: PerLink) -> list[str]:
    scales = _factors(tree, random, "mass_scale", given)
    for link, scale in scales.items():
        old = _inertia(tree, link)
        new = replace(old, mass=scale * old.mass, about_com=scale * old.about_com)
        write_inertia(tree.links[link], new)
    return _summary("mass and inertia", scales, moving_links(tree), "× {:.6g}")


def _scale_inertias(tree: UrdfTree, random: RandomNumbers, given: PerLink) -> list[str]:
    scales = _factors(tree, random, "inertia_scale", given)
    for link, scale in scales.items():
        old = _inertia(tree, link)
        write_inertia(tree.links[link], replace(old, about_com=scale * old.about_com))
    return _summary("inertia about the centre of mass", scales, moving_links(tree), "× {:.6g}")


def _factors(
    tree: UrdfTree, random: RandomNumbers, argument: str, given: PerLink
) -> dict[str, float]:
    """Return the factor of each link that has one other than 1."""
    stream = random.stream(argument)
    wanted: dict[str, Number] = spread(argument, given, moving_links(tree), "moving link")
    factors = {
        link: finite_number(argument, stream.number(value), above=0.0)
        for link, value in wanted.items()
    }
    return {link: factor for link, factor in factors.items() if factor != 1.0}


def _shift_centres(
    tree: UrdfTree, random: RandomNumbers, given: Shift | Mapping[str, Shift]
) -> list[str]:
    stream = random.stream("com_shift")
    changes = []
    wanted: dict[str, Shift] = spread("com_shift", given, moving_links(tree), "moving link")
    for link, value in wanted.items():
        if isinstance(value, Uniform) or np.ndim(value) == 0:
            length = finite_number("com_shift", stream.number(cast("Number", value)), at_least=0.0)
            shift = length * stream.direction() if length else np.zeros(3)
        else:
            shift = finite_vector("com_shift", value, 3)
        if not shift.any():
            continue
        old = _inertia(tree, link)
        write_inertia(tree.links[link], replace(old, com=old.com + shift))
        millimetres = ", ".join(f"{1e3 * part:.4g}" for part in shift)
        changes.append(f"centre of mass of {link} moved by ({millimetres}) mm")
    return changes


def _repair(tree: UrdfTree) -> list[str]:
    changes = []
    for link in moving_links(tree):
        inertia = _inertia(tree, link)
        if not inertia.is_consistent():
            write_inertia(tree.links[link], inertia.made_consistent())
            changes.append(f"inertia of {link} raised to obey the triangle inequality")
    return changes


def _attach_payloads(
    tree: UrdfTree,
    random: RandomNumbers,
    given: Number | Payload | Sequence[Payload],
    tool_frame: str,
) -> list[str]:
    if isinstance(given, Sequence):
        payloads = list(given)
    elif isinstance(given, Payload):
        payloads = [given]
    else:
        mass = random.stream("payload").number(given)
        payloads = [Payload(mass=finite_number("payload", mass, at_least=0.0))]
    if not all(isinstance(payload, Payload) for payload in payloads):
        raise ArgumentError("payload", given, "give a mass, a Payload or a list of them")
    stream = random.stream("payload")
    changes = []
    for payload in payloads:
        body = payload.drawn(stream)
        if body.kilograms > 0.0:
            name = attach(body, tree, tool_frame)
            changes.append(f"{name} of {body.kilograms:.6g} kg at {body.frame or tool_frame}")
    return changes


def _set_per_joint(
    tree: UrdfTree,
    random: RandomNumbers,
    what: str,
    given: PerJoint | PerLink,
    joint_names: Sequence[str],
) -> list[str]:
    stream = random.stream(what)
    if isinstance(given, (Uniform, Mapping)):
        wanted: PerLink = given
        spread_out: dict[str, Number] = spread(what, wanted, joint_names, "moving joint")
        values = {joint: stream.number(value) for joint, value in spread_out.items()}
    else:
        values = joint_values(what, given, joint_names)
    for joint, value in values.items():
        check_property(what, value)
        write_properties(tree, tree.joints[joint], {what: value})
    return _summary(what, values, joint_names, "= {:.6g}")


def _summary(
    what: str, values: Mapping[str, float], everyone: Sequence[str], form: str
) -> list[str]:
    """One line when all have the same value, else one for each."""
    if len(values) == len(everyone) and len(set(values.values())) == 1:
        return [f"{what} of all {form.format(next(iter(values.values())))}"]
    return [f"{what} of {name} {form.format(value)}" for name, value in values.items()]
