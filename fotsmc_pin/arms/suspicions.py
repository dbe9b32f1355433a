"""What looks wrong in an arm, in plain words: each check is one law that real arms obey."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms.inertia import read_inertia
from fotsmc_pin.arms.perturbation import moving_links
from fotsmc_pin.arms.tool_point import joint_under
from fotsmc_pin.arms.visuals import find_mesh

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.types import Array

HIGHEST_EFFORT = 5e3  # N·m or N: beyond any arm's motors.
HIGHEST_SPEED = 50.0  # rad/s or m/s.
HIGHEST_CONDITION = 1e5


def suspicions(arm: Arm, *, gravity_load: Array, condition: float) -> Iterator[str]:
    """Yield a sentence for each thing that looks wrong."""
    yield from _limits(arm)
    yield from _inertias(arm)
    yield from _massless_links(arm)
    for joint, load, limit in zip(arm.joint_names, gravity_load, arm.effort_limit, strict=True):
        if load > limit:
            yield (
                f"{joint}: gravity asks for up to {load:.3g}, {load / limit:.2f} times the effort "
                "limit; the arm cannot hold itself everywhere"
            )
    if arm.idle_joint is not None:
        yield (
            f"{arm.idle_joint}: moves no inertia of its own; the arm cannot be simulated unless "
            "its armature or the inertia of what it carries is given"
        )
    elif condition > HIGHEST_CONDITION:
        yield (
            f"the mass matrix has a condition number of {condition:.1e}; the lightest joints will "
            "answer violently, consider giving their armature"
        )
    last = joint_under(arm.tree, arm.tool_frame)
    if last is not None:
        yield (
            f"the tool frame {arm.tool_frame} lies at the origin of {last}: payloads, the mass "
            "that the limits hold and tool paths are those of this joint; tool_frame=... moves it"
        )
    yield from _meshes(arm)


def _limits(arm: Arm) -> Iterator[str]:
    for what, values, highest in (
        ("effort", arm.effort_limit, HIGHEST_EFFORT),
        ("velocity", arm.velocity_limit, HIGHEST_SPEED),
    ):
        missing = [
            joint
            for joint, value in zip(arm.joint_names, values, strict=True)
            if not np.isfinite(value)
        ]
        if missing:
            yield f"no {what} limit is given for {', '.join(missing)} (0 or inf means not given)"
        for joint, value in zip(arm.joint_names, values, strict=True):
            if highest < value < np.inf:
                yield f"{joint}: {what} limit {value:g} is beyond any arm's"
    endless = [
        joint
        for joint, lower, upper in zip(
            arm.joint_names, arm.lower_position_limit, arm.upper_position_limit, strict=True
        )
        if np.isinf(lower) and np.isinf(upper) and arm.tree.joints[joint].type != "continuous"
    ]
    if endless:
        yield f"no position limits are given for {', '.join(endless)}"


def _inertias(arm: Arm) -> Iterator[str]:
    links = moving_links(arm.tree)
    reach = _reach(arm)
    for link in links:
        inertia = read_inertia(arm.tree, link)
        if inertia is None:
            continue
        gyration = np.sqrt(max(0.0, float(np.trace(inertia.about_com)) / 2.0) / inertia.mass)
        if not inertia.about_com.any():
            yield f"{link}: zero rotational inertia, a point mass"
        elif not inertia.is_consistent(1e-6):
            moments = np.linalg.eigvalsh(inertia.about_com)
            yield (
                f"{link}: no body has principal moments of inertia of "
                f"{', '.join(f'{moment:.3g}' for moment in moments)} kg·m² "
                "(each is at most the sum of the other two)"
            )
        elif gyration > max(0.5 * reach, 0.05):
            yield (
                f"{link}: a rotational inertia of {np.trace(inertia.about_com) / 3:.3g} kg·m² on "
                f"{inertia.mass:.3g} kg is that of a body of {2 * gyration:.2g} m; check its unit"
            )
        if np.linalg.norm(inertia.com) > max(reach, 0.1):
            yield f"{link}: its centre of mass lies {np.linalg.norm(inertia.com):.3g} m away"


def _massless_links(arm: Arm) -> Iterator[str]:
    """Warn of visible links that weigh nothing: bare frames are common, bodies are mistakes."""
    tree = arm.tree
    moved = {name for joint in tree.moving_joints for name in tree.rigid_body(joint.child)}
    for link, element in tree.links.items():
        inertia = read_inertia(tree, link)
        mass = 0.0 if inertia is None else inertia.mass
        if link in moved and mass == 0.0 and element.find("visual") is not None:
            yield f"{link}: is drawn and weighs nothing"


def _reach(arm: Arm) -> float:
    """Length of the longest chain of links [m], its slides out by a metre at most."""
    tree = arm.tree

    def length(link: str) -> float:
        total = 0.0
        for joint in tree.chain(link):
            origin = joint.element.find("origin")
            total += float(np.linalg.norm(tree.numbers(origin, "xyz", (0.0, 0.0, 0.0), joint.name)))
            total += 1.0 if joint.type == "prismatic" else 0.0
        return total

    # The tool frame may have been placed by the very numbers that are to be judged.
    return max(length(link) for link in tree.links if link != arm.tool_frame)


def _meshes(arm: Arm) -> Iterator[str]:
    missing = {
        address
        for element in arm.tree.robot.iterfind("link/visual/geometry/mesh")
        if find_mesh(address := element.get("filename", ""), arm.package_dirs) is None
    }
    for address in sorted(missing):
        yield f"mesh {address!r} is not there; dynamics are not affected, package_dirs may help"
