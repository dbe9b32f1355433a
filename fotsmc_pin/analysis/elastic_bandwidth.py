"""`largest_bandwidth`: how fast a loop may be on joints that are not stiff."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.analysis.margins import distinct
from fotsmc_pin.analysis.sampled_loop import Joint, edge, is_stable
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.control import Controller

SMALLEST, LARGEST = 0.01, 2.0
"""Bandwidths between which an edge is looked for."""
STEPS, BISECTIONS = 12, 6
SIDES = ("motor", "link")


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
    nominal inertia of that joint at the neutral configuration with the others at rest.

    Args:
        controller: a law with a gain `bandwidth`.
        joint_stiffness: of each joint, one number or (nv,) [N·m/rad].
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
    k = checks.per_joint("joint_stiffness", joint_stiffness, arm.nv, above=0.0)
    J = checks.per_joint("rotor", rotor, arm.nv, above=0.0)
    ratio = checks.finite_number("damping_ratio", damping_ratio, at_least=0.0)
    link_side = checks.choice("encoder", encoder, [*SIDES]) == "link"
    inertia = np.diag(arm.mass_matrix(arm.neutral))
    if (inertia <= J).any():
        remedy = "the nominal inertia must contain the rotor's: load the arm with that armature"
        raise ArgumentError("rotor", J, remedy)
    share = J / inertia
    reduced = inertia * share * (1.0 - share)
    joints = [
        Joint(
            rotor=share[j],
            stiffness=k[j] / inertia[j],
            damping=2.0 * ratio * float(np.sqrt(k[j] * reduced[j])) / inertia[j],
            link_side=link_side,
        )
        for j in range(arm.nv)
    ]
    given = {f: getattr(controller.gains, f) for f in controller.gains.__dataclass_fields__}

    def stable(bandwidth: float) -> bool:
        scaled = type(controller)(arm, controller.dt, **{**given, "bandwidth": bandwidth})
        laws = linearize(scaled, joints=first)
        return all(is_stable(laws[k], joint, delay) for k, joint in zip(place, joints, strict=True))

    # Joints with equal gains have equal laws: one of each kind is enough.
    place, _ = distinct(linearize(controller))
    first = [place.index(k) for k in range(max(place) + 1)]
    found = edge(stable, SMALLEST, LARGEST, STEPS, BISECTIONS)
    if np.isnan(found):
        raise ArgumentError("joint_stiffness", joint_stiffness, "no bandwidth is stable on it")
    return found
