"""What is learnt of an arm: the parameters in their order, and what is believed beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

LINKS = 0.3
"""Standard deviation of a link's mass over its nominal one."""
PAYLOAD = 0.15
"""Standard deviation of the payload over the mass of the moving links."""
CENTRES = 0.01
"""Standard deviation of a link's centre of mass from the nominal one, along each axis [m]."""
OFFSET = 0.1
"""Standard deviation of the payload's centre from the tool frame [m], at such a payload."""
LIMIT_OVER_ARMATURE = 150.0
"""Effort limit over the standard deviation of an armature [rad/s², m/s²]."""
FRICTION, FULL_EFFORT = 0.5, 20.0
"""Standard deviation of Coulomb [N·m] and viscous [N·m·s/rad] friction of a joint with at least
this effort limit; of a weaker one in proportion less."""


class Beliefs(NamedTuple):
    """One number per parameter, (p,), for each of what is believed.

    Attributes:
        mean: expected beforehand, which is what the nominal arm has.
        deviation: standard deviation beforehand.
        lowest: least that is possible.
        highest: most that is possible.
        estimate: learnt so far.
        sigma: its standard deviation.
        used: what the law is given.
        work: scratch of the update.
    """

    mean: Array
    deviation: Array
    lowest: Array
    highest: Array
    estimate: Array
    sigma: Array
    used: Array
    work: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Prior:
    """What is believed of an arm before it moves, as standard deviations around its file's numbers.

    Attributes:
        links: of each link's mass and inertia over the nominal one, (nv,) or one number.
        centres: of each link's centre of mass along each axis [m].
        payload: of the payload at the tool [kg]; None for 0.15 of the mass of the moving links.
        offset: of the payload's centre of mass from the tool frame [m].
        armature: of the motor inertia, by joint [kg·m² or kg]; None for effort limit / 150.
        damping: of viscous friction, by joint [N·m·s/rad or N·s/m]; None for 0.5, less below an
            effort limit of 20 N·m, and at least what the arm's file says.
        friction: of Coulomb friction, by joint [N·m or N]; None for the same in these units.
        stribeck: of what friction at standstill exceeds Coulomb friction by, [N·m or N]; None
            leaves it out.
        stribeck_velocity: speed of its fall, by joint [rad/s or m/s].
    """

    links: ArrayLike = LINKS
    centres: float = CENTRES
    payload: float | None = None
    offset: float = OFFSET
    armature: ArrayLike | None = None
    damping: ArrayLike | None = None
    friction: ArrayLike | None = None
    stribeck: ArrayLike | None = None
    stribeck_velocity: float = 0.05


class Layout:
    """The order of the parameters of an arm.

    First those that all joints' rows know: a factor on each link, four of the payload, three first
    moments of each link. Then each joint's own, kind by kind: armature, damping, friction, and what
    friction at standstill is more, where that is learnt.

    Attributes:
        groups: place of each group of parameters, by name.
        size: how many parameters there are, `p`.
        columns: how many of them a joint's row knows, `c`.
    """

    def __init__(self, joints: int, *, stribeck: bool) -> None:
        own = ("armature", "damping", "friction", *(("stribeck",) if stribeck else ()))
        shared = shared_columns(joints)
        self.groups = {
            "link_scale": slice(0, joints),
            "payload": slice(joints, joints + 4),
            "link_moment": slice(joints + 4, shared),
        }
        for k, name in enumerate(own):
            start = shared + k * joints
            self.groups[name] = slice(start, start + joints)
        self.columns = shared + len(own)
        self.size = shared + len(own) * joints


@kernel(is_part=True)
def shared_columns(joints: int) -> int:
    """Return how many parameters all joints' rows know."""
    return 4 * joints + 4


def first_beliefs(arm: Arm, prior: Prior, layout: Layout) -> Array:
    """Return the table of `Beliefs` before anything is learnt, (8, p).

    Raises:
        ArgumentError: a deviation below zero or of the wrong shape.
    """
    n, size = arm.nv, drive_size(arm)

    def given(name: str, default: Array) -> Array:
        value = getattr(prior, name)
        return default if value is None else checks.per_joint(name, value, n, at_least=0.0)

    masses = [float(inertia.mass) for inertia in [*arm.model.inertias][1:]]
    payload = checks.finite_number(
        "payload", PAYLOAD * sum(masses) if prior.payload is None else prior.payload, at_least=0.0
    )
    rubbing = FRICTION * np.minimum(1.0, size / FULL_EFFORT)
    moment = np.full(3, payload * checks.finite_number("offset", prior.offset, at_least=0.0))
    links = checks.per_joint("links", prior.links, n, at_least=0.0)
    centres = checks.finite_number("centres", prior.centres, at_least=0.0)
    moments = centres * np.repeat(masses, 3)
    armature = given("armature", size / LIMIT_OVER_ARMATURE)
    damping = given("damping", np.maximum(rubbing, arm.damping))
    friction = given("friction", np.maximum(rubbing, arm.friction))
    parts = {
        "link_scale": (np.ones(n), links, np.full(n, 0.2), np.full(n, 5.0)),
        "payload": (
            np.zeros(4),
            np.array([payload, *moment]),
            np.array([0.0, *(-2.0 * moment)]),
            np.array([6.0 * payload, *(2.0 * moment)]),
        ),
        "link_moment": (np.zeros(3 * n), moments, -4.0 * moments, 4.0 * moments),
        "armature": (arm.armature, armature, np.zeros(n), arm.armature + 15.0 * armature),
        "damping": (arm.damping, damping, np.zeros(n), arm.damping + 40.0 * damping),
        "friction": (arm.friction, friction, np.zeros(n), arm.friction + 10.0 * friction),
    }
    if "stribeck" in layout.groups:
        more = given("stribeck", friction)
        parts["stribeck"] = (np.zeros(n), more, np.zeros(n), 4.0 * more)
    table = np.zeros((len(Beliefs._fields), layout.size))
    beliefs = Beliefs(*table)
    for name, place in layout.groups.items():
        mean, deviation, lowest, highest = parts[name]
        beliefs.mean[place], beliefs.deviation[place] = mean, deviation
        beliefs.lowest[place], beliefs.highest[place] = lowest, highest
    beliefs.estimate[:] = beliefs.used[:] = beliefs.mean
    beliefs.sigma[:] = beliefs.deviation
    return table
