"""`largest_bandwidth`: how fast a loop may be on joints that are not stiff."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, overload

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.analysis.sampled_loop import Joint, edge, is_stable
from fotsmc_pin.analysis.spring_loop import behind_springs
from fotsmc_pin.control import SpringObserver
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike

    from fotsmc_pin.analysis.linearization import LinearLaw
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.types import Array

SMALLEST, LARGEST = 0.01, 2.0
"""Bandwidths between which an edge is looked for."""
STEPS, BISECTIONS = 9, 6
STEP_DOWN = 0.95
SIDES = ("motor", "link")
OBSERVED_SHARE: Mapping[str, float] = MappingProxyType({"link": 0.6, "motor": 0.8})
"""Share of `largest_bandwidth` at which a law is best run in a `SpringObserver`, by the side of the
encoders: on a whole arm springs shake each other, and near the edge noise of encoders on the links
becomes a rattling torque."""
LINKS = (0.7, 1.0, 1.4, 2.0)
"""True over nominal inertia on the link's side, with each of which a loop must be stable where a
`SpringObserver` takes the link's model for its estimate."""


class BandwidthWarning(UserWarning):
    """The law is faster than the springs of the true arm's joints allow."""


def largest_bandwidth(
    controller: Controller | SpringObserver,
    joint_stiffness: ArrayLike | None = None,
    *,
    rotor: ArrayLike | None = None,
    damping_ratio: float = 0.02,
    encoder: str = "link",
    delay: int = 1,
) -> float:
    """Return the largest `bandwidth` with which a law is stable on elastic joints.

    Each joint is taken as Spong's two masses: `rotor` behind a spring, and the rest of the
    nominal inertia of that joint at the neutral configuration with the others at rest. That the
    joints' springs shake each other is left out: in simulation, a Panda and a UR5 come to rest at
    0.8 of what is returned on either side, and swing for ever at 1.1.

    A `SpringObserver` has to be stable with links of 0.7 to 2 times their nominal inertia, since
    its estimate rests on that. Stiffness, rotor and damping are those that it was given.

    Args:
        controller: a law with a gain `bandwidth`, or a `SpringObserver` around one.
        joint_stiffness: of each joint, one number or (nv,) [N·m/rad]; inf for a rigid one. Not for
            a `SpringObserver`.
        rotor: inertia on the motor's side, one number or (nv,) [kg·m²]; below that of the joint.
            The arm's armature by default; not for a `SpringObserver`.
        damping_ratio: of the spring between its two masses; not for a `SpringObserver`.
        encoder: "motor" or "link": the side that is measured; not for a `SpringObserver`.
        delay: ticks of delay.

    Raises:
        ArgumentError: a law without a `bandwidth`, numbers out of range, or no bandwidth at all.
    """
    name = type(controller).__name__
    if not hasattr(controller.gains, "bandwidth"):
        raise ArgumentError("controller", name, "give a law with a gain `bandwidth`")
    if isinstance(controller, SpringObserver):
        own_side = encoder in ("link", controller.encoder)
        if joint_stiffness is not None or rotor is not None or not own_side:
            remedy = "a SpringObserver has its own; leave it out"
            raise ArgumentError("joint_stiffness, rotor or encoder", joint_stiffness, remedy)
        found = _observed_edge(controller, delay)
    else:
        if joint_stiffness is None:
            raise ArgumentError("joint_stiffness", None, "give that of each joint, or inf")
        own = controller.arm.armature if rotor is None else rotor
        joints = _joints(controller.arm, joint_stiffness, own, damping_ratio, encoder)

        def stable(bandwidth: float) -> bool:
            return _stable_on(with_bandwidth(controller, bandwidth), joints, delay)

        found = edge(stable, SMALLEST, LARGEST, STEPS, BISECTIONS)
    if np.isnan(found):
        raise ArgumentError("joint_stiffness", joint_stiffness, "no bandwidth is stable on it")
    return found


def _observed_edge(observer: SpringObserver, delay: int) -> float:
    """Return the largest bandwidth with an observer; NaN where none is stable.

    Joints have much the same law, whose linearisation takes most of the time: the edge is looked
    for with the first one's, and what is found is tried with each joint's own.
    """

    def stable(bandwidth: float) -> bool:
        (first,) = linearize(with_bandwidth(observer.law, bandwidth), joints=[0])
        return _bears_links(behind_springs(observer, [first] * observer.arm.nv, None), delay)

    found = edge(stable, SMALLEST, LARGEST, STEPS, BISECTIONS)
    while found >= SMALLEST:
        if _bears_links(linearize(with_bandwidth(observer, found)), delay):
            return found
        found *= STEP_DOWN
    return float("nan")


def _bears_links(laws: Sequence[LinearLaw], delay: int) -> bool:
    return all(is_stable(law, law.joint.loaded(m), delay) for law in laws for m in LINKS)


@overload
def with_bandwidth(controller: SpringObserver, bandwidth: float) -> SpringObserver: ...
@overload
def with_bandwidth(controller: Controller, bandwidth: float) -> Controller: ...
def with_bandwidth(
    controller: Controller | SpringObserver, bandwidth: float
) -> Controller | SpringObserver:
    """Return a controller like another, or a `SpringObserver` around one, of another bandwidth."""
    if isinstance(controller, SpringObserver):
        return controller.around(with_bandwidth(controller.law, bandwidth))
    given = {
        name: getattr(controller.gains, name) for name in controller.gains.__dataclass_fields__
    }
    return type(controller)(controller.arm, controller.dt, **{**given, "bandwidth": bandwidth})


def warn_of_soft_joints(
    controller: Controller | SpringObserver, true: Arm, *, encoder: str = "link", delay: int = 1
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
    links = np.diag(arm.mass_matrix(arm.neutral)) - arm.armature
    share = true.armature / (links + true.armature)
    joints = _springs(
        true.joint_stiffness,
        share,
        np.diag(arm.mass_matrix(arm.neutral)),
        (links + true.armature) / np.diag(arm.mass_matrix(arm.neutral)),
        true.joint_damping,
        encoder,
    )
    try:
        stable = _stable_on(controller, joints, delay)
    except ArgumentError:  # a law of another form
        return
    if not stable:
        name = getattr(controller, "label", type(controller).__name__)
        bare = not isinstance(controller, SpringObserver)
        remedy = f"wrap it in a SpringObserver for encoders on the {encoder}s, or " if bare else ""
        warn_user(
            f"{name} is too fast for the springs of {true.name} with encoders "
            f"on the {encoder} side; {remedy}lower its rates (`bandwidth`), see "
            "fotsmc_pin.analysis.largest_bandwidth",
            BandwidthWarning,
        )


def _stable_on(
    controller: Controller | SpringObserver, joints: Sequence[Joint], delay: int
) -> bool:
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
