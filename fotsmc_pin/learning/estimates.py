"""`Estimates`: what was learnt of an arm, and how well it is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms import Payload, perturb, with_known_friction
from fotsmc_pin.arms.markup import parse_urdf
from fotsmc_pin.arms.perturbation import moving_links
from fotsmc_pin.arms.tool_point import placement
from fotsmc_pin.arms.tree import UrdfTree
from fotsmc_pin.learning.trust import FARTHEST, FARTHEST_LINK

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.learning.parameters import Beliefs, Layout
    from fotsmc_pin.types import Array

LIGHTEST = 1e-3
"""Mass below which nothing is held [kg]."""
KNOWN = 0.5
"""Share of the standard deviation beforehand below which a parameter counts as known."""
ROTARY = {"armature": "kg·m²", "damping": "N·m·s/rad", "friction": "N·m", "stribeck": "N·m"}
SLIDING = {"armature": "kg", "damping": "N·s/m", "friction": "N", "stribeck": "N"}


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One parameter.

    Attributes:
        group: kind of parameter, as the signal is called.
        of: the link, joint or direction.
        value: the estimate.
        deviation: its standard deviation.
        first_value: what was expected beforehand.
        first_deviation: how sure that was.
        unit: of all four.
    """

    group: str
    of: str
    value: float
    deviation: float
    first_value: float
    first_deviation: float
    unit: str

    @property
    def known(self) -> bool:
        """Whether at least half of the doubt is gone."""
        return self.deviation < KNOWN * self.first_deviation


@dataclass(frozen=True)
class Estimates:
    """All parameters; a sequence of `Estimate`, printed as a table.

    Attributes:
        rows: one for each parameter.
    """

    rows: tuple[Estimate, ...]

    @classmethod
    def of(cls, arm: Arm, layout: Layout, beliefs: Beliefs) -> Estimates:
        """Return a copy of the beliefs about an arm, by name."""
        sliding = [joint.shortname().startswith("JointModelP") for joint in arm.model.joints[1:]]
        links = [" and ".join(body) for body in moving_bodies(arm)]
        rows = []
        for group, place in layout.groups.items():
            if group == "link_scale":
                names, units = links, [""] * arm.nv
            elif group == "link_moment":
                names = [f"{link} {axis}" for link in links for axis in "xyz"]
                units = ["kg·m"] * (3 * arm.nv)
            elif group == "payload":
                names, units = ["mass", "moment x", "moment y", "moment z"], ["kg", *["kg·m"] * 3]
            else:
                names = list(arm.joint_names)
                units = [(SLIDING if slides else ROTARY)[group] for slides in sliding]
            columns = (
                beliefs.estimate,
                beliefs.sigma,
                beliefs.mean,
                beliefs.deviation,
            )
            numbers = zip(*(column[place].tolist() for column in columns), strict=True)
            rows += [
                Estimate(
                    group=group,
                    of=name,
                    value=value,
                    deviation=deviation,
                    first_value=first,
                    first_deviation=doubt,
                    unit=unit,
                )
                for name, unit, (value, deviation, first, doubt) in zip(
                    names, units, numbers, strict=True
                )
            ]
        return cls(tuple(rows))

    def __iter__(self) -> Iterator[Estimate]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def group(self, name: str) -> list[Estimate]:
        """Return the estimates of one kind, in the order of the joints."""
        return [row for row in self.rows if row.group == name]

    def __str__(self) -> str:
        """Return the table: what is known, and what could not be told."""
        known = [row for row in self.rows if row.known]
        unknown = [row for row in self.rows if not row.known]
        lines = [
            f"{row.group} {row.of}: {row.value:.4g} ± {row.deviation:.2g} {row.unit}".rstrip()
            for row in known
        ]
        if unknown:
            names = ", ".join(f"{row.group} {row.of}" for row in unknown)
            lines.append(f"not told by the motion so far: {names}")
        return "\n".join(lines)


def moving_bodies(arm: Arm) -> list[list[str]]:
    """Return for each joint the links with mass that move as one body behind it."""
    tree = UrdfTree(parse_urdf(arm.urdf, arm.name), arm.name)
    heavy = set(moving_links(tree))
    bodies = [tree.rigid_body(tree.joints[name].child) for name in arm.joint_names]
    return [[link for link in body if link in heavy] for body in bodies]


def learned_arm(arm: Arm, estimates: Estimates) -> Arm:
    """Return the arm with all estimates written in.

    All of them, also those that are hardly known: they belong together, and one that the motion
    did not tell stands where it was beforehand.
    """
    scales = {
        link: row.value
        for row, body in zip(estimates.group("link_scale"), moving_bodies(arm), strict=True)
        for link in body
    }
    mass, *moment = (row.value for row in estimates.group("payload"))
    held = [_payload(arm, mass, np.array(moment))] if mass > LIGHTEST else []

    def values(group: str) -> list[float]:
        return [row.value for row in estimates.group(group)]

    learned = perturb(
        arm,
        mass_scale=scales,
        com_shift=_shifts(arm, estimates),
        payload=held,
        armature=values("armature"),
        damping=values("damping"),
        friction=values("friction"),
        name=f"{arm.name}_learned",
    )
    return with_known_friction(learned)


def _shifts(arm: Arm, estimates: Estimates) -> dict[str, Array]:
    """Return the shift of the centre of mass of each link, (3,) in its own axes [m]."""
    tree = UrdfTree(parse_urdf(arm.urdf, arm.name), arm.name)
    scales = [row.value for row in estimates.group("link_scale")]
    moments = np.reshape([row.value for row in estimates.group("link_moment")], (-1, 3))
    shifts: dict[str, Array] = {}
    for k, body in enumerate(moving_bodies(arm)):
        mass = scales[k] * float(arm.model.inertias[k + 1].mass)
        shift = np.clip(moments[k] / mass, -FARTHEST_LINK, FARTHEST_LINK) if body else np.zeros(3)
        shifts |= {link: placement(tree, link).rotation.T @ shift for link in body}
    return shifts


def _payload(arm: Arm, mass: float, moment: Array) -> Payload:
    """Return a point mass, its place in the axes of the tool frame."""
    frame = arm.model.frames[arm.model.getFrameId(arm.tool_frame, pin.FrameType.BODY)]
    offset = np.clip(moment / mass, -FARTHEST, FARTHEST)
    place = frame.placement.rotation.T @ offset
    return Payload(mass=mass, com=place, inertia=np.zeros(3))
