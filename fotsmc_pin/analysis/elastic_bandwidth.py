"""`largest_bandwidth`: how fast a loop may be on joints that are not stiff."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.analysis.sampled_loop import Joint, edge, is_stable
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.types import Array

SMALLEST, LARGEST = 0.01, 2.0
"""Bandwidths between which an edge is looked for."""
STEPS, BISECTIONS = 12, 6
SIDES = ("motor", "link")


class BandwidthWarning(UserWarning):
    """The law is faster than the springs of the true arm's joints allow."""


def largest_bandwidth(
    controller: Controller,
    joint_stiffness: ArrayLike,
    *,
    rotor: ArrayLike,
    damping_ratio: float = 0.02,
    encoder: str = "link",
    delay: int = 1,
) -> float:
    """Return the largest `bandwidth` with which a law is stable on elastic joints.

    Each joint is taken as Spong's two masses: `rotor` behind a spring, and the rest of the
    nominal inertia of that joint at the neutral configuration with the others at rest. That the
    joints' springs shake each other is left out: in simulation, a Panda and a UR5 come to rest at
    0.8 of what is returned on either side, and swing for ever at 1.1.

    Args:
        controller: a law with a gain `bandwidth`.
        joint_stiffness: of each joint, one number or (nv,) [N·m/rad]; inf for a rigid one.
        rotor: inertia on the motor's side, one number or (nv,) [kg·m²]; below that of the joint.
        damping_ratio: of the spring between its two masses.
        encoder: "motor" or "link": the side that is measured.
        delay: ticks of delay.

    Raises:
        ArgumentError: a law without a `bandwidth`, numbers out of range, or no bandwidth at all.
    """
    arm, name = controller.arm, type(controller).__name__
    if not hasattr(controller.gains, "bandwidth"):
        raise ArgumentError("controller", name, "give a law with a gain `bandwidth`")
    joints = _joints(arm, joint_stiffness, rotor, damping_ratio, encoder)
    given = {f: getattr(controller.gains, f) for f in controller.gains.__dataclass_fields__}

    def stable(bandwidth: float) -> bool:
        scaled = type(controller)(arm, controller.dt, **{**given, "bandwidth": bandwidth})
        return _stable_on(scaled, joints, delay)

    found = edge(stable, SMALLEST, LARGEST, STEPS, BISECTIONS)
    if np.isnan(found):
        raise ArgumentError("joint_stiffness", joint_stiffness, "no bandwidth is stable on it")
    return found


def warn_of_soft_joints(
    controller: Controller, true: Arm, *, encoder: str = "link", delay: int = 1
) -> None:
    """Warn before a run where a law is too fast for the springs of the true arm.

    One look at the linear loop of each elastic joint; `largest_bandwidth` says what it bears.
    Silent for rigid arms, and for laws whose loop `margins` cannot tell.

    Args:
        controller: the law.
        true: the arm that moves, with its `joint_stiffness` and its armature as rotors.
        encoder: "motor" or "link": the side that is measured.
        delay: ticks of delay.

    Warns:
        BandwidthWarning: the loop is unstable, and what to do.
    """
    if not np.isfinite(true.joint_stiffness).any():
        return
    arm = controller.arm
    # Spring against the nominal inertia, which must hold the rotor: what is missing there is added.
    bare = np.diag(arm.mass_matrix(arm.neutral)) - arm.armature
    share = true.armature / (bare + true.armature)
    joints = _springs(
        true.joint_stiffness,
        share,
        np.diag(arm.mass_matrix(arm.neutral)),
        (bare + true.armature) / np.diag(arm.mass_matrix(arm.neutral)),
        true.joint_damping,
        encoder,
    )
    try:
        stable = _stable_on(controller, joints, delay)
    except ArgumentError:  # a law of another form
        return
    if not stable:
        warn_user(
            f"{type(controller).__name__} is too fast for the springs of {true.name} with encoders "
            f"on the {encoder} side; lower its rates (`bandwidth`), see "
            "fotsmc_pin.analysis.largest_bandwidth",
            BandwidthWarning,
        )


def _stable_on(controller: Controller, joints: Sequence[Joint], delay: int) -> bool:
    laws = linearize(controller)
    return all(is_stable(law, joint, delay) for law, joint in zip(laws, joints, strict=True))


def _joints(
    arm: Arm, stiffness: ArrayLike, rotor: ArrayLike, ratio: float, encoder: str
) -> list[Joint]:
    k = checks.per_joint("joint_stiffness", stiffness, arm.nv, above=0.0, unlimited=True)
    J = checks.per_joint("rotor", rotor, arm.nv, at_least=0.0)
    ratio = checks.finite_number("damping_ratio", ratio, at_least=0.0)
    inertia = np.diag(arm.mass_matrix(arm.neutral))
    elastic = np.isfinite(k)
    if ((J <= 0.0) & elastic).any():
        raise ArgumentError("rotor", J, "an elastic joint has a motor: give its rotor's inertia")
    if ((inertia <= J) & elastic).any():
        remedy = "the nominal inertia must contain the rotor's: load the arm with that armature"
        raise ArgumentError("rotor", J, remedy)
    share = J / inertia
    reduced = inertia * share * (1.0 - share)
    damping = 2.0 * ratio * np.sqrt(np.where(elastic, k, 0.0) * reduced)
    return _springs(k, share, inertia, np.ones(arm.nv), damping, encoder)


def _springs(
    k: Array, share: Array, inertia: Array, mass: Array, damping: Array, encoder: str
) -> list[Joint]:
    link_side = checks.choice("encoder", encoder, [*SIDES]) == "link"
    return [
        Joint(
            mass=mass[j],
            rotor=share[j],
            stiffness=k[j] / inertia[j],
            damping=damping[j] / inertia[j],
            link_side=link_side,
        )
        for j in range(len(k))
    ]
