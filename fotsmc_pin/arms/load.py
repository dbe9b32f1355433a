"""`load_arm`: from a name or a URDF file to an `Arm`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from fotsmc_pin.arms.arm import Arm
from fotsmc_pin.arms.catalog import find_source, shared_folders
from fotsmc_pin.arms.inertia import moving_mass
from fotsmc_pin.arms.locking import apply_locks, choose_locks
from fotsmc_pin.arms.markup import parse_urdf, urdf_text
from fotsmc_pin.arms.model import build_model
from fotsmc_pin.arms.mounting import turn_base
from fotsmc_pin.arms.overrides import apply_overrides
from fotsmc_pin.arms.properties import complete_limits, read_properties
from fotsmc_pin.arms.rotors import LIMIT_OVER_ARMATURE, ROTORS, rotor_inertias
from fotsmc_pin.arms.tool_frame import default_tool_frame, note_tool_frame, noted_tool_frame
from fotsmc_pin.arms.tree import UrdfTree
from fotsmc_pin.arms.visuals import anchor_meshes, package_folders
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from os import PathLike

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms.locking import Patterns
    from fotsmc_pin.arms.overrides import PerJoint


def load_arm(
    source: str | PathLike[str],
    *,
    package_dirs: Iterable[str | PathLike[str]] = (),
    lock: Patterns | Mapping[str, float] | None = None,
    keep: Patterns | None = None,
    armature: PerJoint | Literal["rotors"] | None = None,
    friction: PerJoint | None = None,
    damping: PerJoint | None = None,
    effort_limit: PerJoint | None = None,
    velocity_limit: PerJoint | None = None,
    lower_position_limit: PerJoint | None = None,
    upper_position_limit: PerJoint | None = None,
    gravity: ArrayLike | None = None,
    tool_frame: str | None = None,
    name: str | None = None,
) -> Arm:
    """Load a robot arm.

    Mimic joints and grippers are locked unless `keep` says otherwise; `Arm.notes` says which.
    A limit of 0 or inf in the file means "not given". Meshes are not touched.

    Numbers per joint may be a scalar, a vector in the order of `Arm.joint_names`, or a mapping
    from joint names or patterns (`{"wrist_*": 0.02}`); they replace the file's.

    Args:
        source: path of a URDF; or the name of a bundled arm ("two_link", "two_link_true"), of one
            in example-robot-data ("panda", "ur5", ...), or of one in robot_descriptions.
        package_dirs: folders that hold the packages which `package://` addresses name. Folders
            above the file, of example-robot-data and of ROS are searched by themselves.
        lock: joints to fix, by name or pattern; a mapping also says where [rad or m].
        keep: the only joints to leave free, by name or pattern.
        armature: motor inertia seen from the joint [kg·m² or kg]; in a file,
            `drake:rotor_inertia` times `drake:gear_ratio` squared. "rotors" estimates it, where the
            file gives none, as effort limit / 200.
        friction: Coulomb friction [N·m or N].
        damping: viscous friction [N·m·s/rad or N·s/m].
        effort_limit: largest effort [N·m or N], inf for none.
        velocity_limit: largest speed [rad/s or m/s], inf for none.
        lower_position_limit: lowest position [rad or m], -inf for none.
        upper_position_limit: highest position [rad or m], inf for none.
        gravity: what the arm feels (3,) [m/s²] in the frame of its base; (0, 0, -9.81) by default,
            (0, 0, 9.81) below a ceiling, (9.81, 0, 0) on a wall with the base's x down, zero in
            space. The arm's URDF becomes that of a turned base, which is also how it is drawn.
        tool_frame: frame at the tool; by default a link with a usual name, else the last link of
            the longest chain, else, if that lies at the last joint, a frame placed beyond it.
        name: what to call the arm.

    Returns:
        The arm.

    Raises:
        ArmNotFoundError: no such file or name.
        UrdfError: the file cannot be used; the message says why and what to do.
        ArgumentError: an unknown joint, a number that no joint can have, or "rotors" for a joint
            without an effort limit.
    """
    if isinstance(package_dirs, str):
        raise ArgumentError("package_dirs", package_dirs, "give a list of folders")
    found = find_source(Path(source) if not isinstance(source, str) else source)
    path = found.path.resolve()
    origin = name or found.name or path.name
    tree = UrdfTree(parse_urdf(path.read_bytes(), origin, keep_head=True), origin)

    locks = choose_locks(tree, lock, keep)
    apply_locks(locks, tree)
    tree = UrdfTree(tree.robot, origin)
    moving_mass(tree)
    notes = [*(str(fixed) for fixed in locks), *_complete(tree)]
    anchor_meshes(tree.robot, path.parent)

    by_rule = isinstance(armature, str)
    if by_rule and armature != ROTORS:
        raise ArgumentError("armature", armature, f"give numbers, or {ROTORS!r} for the rule")
    overrides = {
        "armature": None if by_rule else armature,
        "friction": friction,
        "damping": damping,
        "effort_limit": effort_limit,
        "velocity_limit": velocity_limit,
        "lower_position_limit": lower_position_limit,
        "upper_position_limit": upper_position_limit,
    }
    given = {what: value for what, value in overrides.items() if value is not None}
    joint_names = tuple(build_model(tree).names)[1:] if given or by_rule else ()
    if given:
        apply_overrides(tree, joint_names, given)
        notes += [f"{what} given in place of the file's" for what in given]
    if by_rule:
        rotors = rotor_inertias(tree, joint_names)
        apply_overrides(tree, joint_names, {"armature": rotors})
        notes += [
            f"armature of {joint} estimated as {value:.3g}, effort limit / {LIMIT_OVER_ARMATURE:g}"
            for joint, value in rotors.items()
        ]

    if gravity is not None:
        tree, turned = turn_base(tree, gravity)
        notes.append(turned)

    folders = [
        *(str(Path(folder).resolve()) for folder in package_dirs),
        *found.package_dirs,
        *package_folders(tree.robot, (path.parent, *path.parent.parents, *shared_folders())),
    ]
    hand = {fixed.joint.name for fixed in locks if fixed.is_of_hand}
    tool_frame = tool_frame or noted_tool_frame(tree)
    if tool_frame is None:
        tool_frame, placed = default_tool_frame(tree, hand)
        notes += placed
    note_tool_frame(tree, tool_frame)
    return Arm(
        urdf=urdf_text(tree.robot),
        name=name or found.name or tree.robot.get("name") or path.stem,
        package_dirs=tuple(dict.fromkeys(folders)),
        tool_frame=tool_frame,
        notes=tuple(notes),
    )


def _complete(tree: UrdfTree) -> list[str]:
    """Fill in what parsers demand of moving joints, free mimic joints, and say so."""
    notes = []
    for joint in tree.moving_joints:
        read_properties(tree, joint)
        if complete_limits(joint):
            notes.append(f"{joint.name} gives no effort or velocity limit")
        for mimic in joint.element.findall("mimic"):
            joint.element.remove(mimic)
            notes.append(f"{joint.name} mimics {mimic.get('joint')} in the file, is free here")
    return notes
