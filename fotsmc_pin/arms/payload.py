"""`Payload`: a body held at the tool, or mounted on any frame."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from fotsmc_pin.arms.inertia import LinkInertia, words, write_inertia
from fotsmc_pin.arms.random_numbers import Uniform
from fotsmc_pin.checks import finite_number, finite_vector
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms.random_numbers import Number, RandomStream
    from fotsmc_pin.arms.tree import UrdfTree

STEEL = 7850.0  # Density [kg/m³].
PREFIX = "payload_"
"""Of the names of links that `attach` adds."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Payload:
    """A body fixed to a frame of the arm.

    Attributes:
        mass: [kg]; or a `Uniform` for `perturb` to draw from.
        frame: name of the link that carries it; None for the arm's tool frame.
        com: centre of mass in that frame, (3,) [m].
        inertia: rotational inertia about the centre of mass in the frame's axes, (3, 3), or (3,)
            for its diagonal [kg·m²]; None for a solid steel ball.

    Raises:
        ArgumentError: a mass below zero, or an inertia that no body has.
    """

    mass: Number
    frame: str | None = None
    com: ArrayLike = (0.0, 0.0, 0.0)
    inertia: ArrayLike | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        least = self.mass.low if isinstance(self.mass, Uniform) else self.mass
        finite_number("mass", least, at_least=0.0)
        finite_vector("com", self.com, 3)
        if isinstance(self.mass, Uniform):
            return
        if not self.as_link_inertia().is_consistent():
            raise ArgumentError(
                "inertia",
                self.inertia,
                "no body has it: each principal moment is at most the sum of the other two",
            )

    def drawn(self, stream: RandomStream) -> Payload:
        """Return the payload with its mass drawn, if it is to be."""
        return replace(self, mass=stream.number(self.mass))

    @property
    def kilograms(self) -> float:
        """The mass, once it is known [kg]."""
        return finite_number("mass", cast("float", self.mass))

    @property
    def ball_radius(self) -> float:
        """Radius of a steel ball of this mass [m]."""
        return float(np.cbrt(3.0 * self.kilograms / (4.0 * np.pi * STEEL)))

    def as_link_inertia(self) -> LinkInertia:
        """Return mass, centre of mass and inertia as those of a link."""
        if self.inertia is None:
            about_com = 0.4 * self.kilograms * self.ball_radius**2 * np.eye(3)
        elif np.ndim(self.inertia) == 1:
            about_com = np.diag(finite_vector("inertia", self.inertia, 3))
        else:
            about_com = np.array(self.inertia, dtype=np.float64)
        if about_com.shape != (3, 3) or not np.allclose(about_com, about_com.T):
            raise ArgumentError("inertia", self.inertia, "give 3 moments or a symmetric (3, 3)")
        com = finite_vector("com", self.com, 3)
        return LinkInertia(mass=self.kilograms, com=com, rpy=np.zeros(3), about_com=about_com)


def attach(payload: Payload, tree: UrdfTree, default_frame: str) -> str:
    """Add a payload to the tree as a link on a fixed joint and return the link's name.

    Raises:
        ArgumentError: the frame is no link of the arm.
    """
    frame = payload.frame or default_frame
    if frame not in tree.links:
        known = ", ".join(tree.links)
        raise ArgumentError("frame", frame, f"no link has this name; known: {known}")
    taken = {element.get("name") for element in tree.robot}
    numbers = (f"{PREFIX}{number}" for number in itertools.count(1))
    name = next(name for name in numbers if not taken & {name, f"{name}_joint"})
    link = ET.SubElement(tree.robot, "link", name=name)
    write_inertia(link, payload.as_link_inertia())
    visual = ET.SubElement(link, "visual")
    ET.SubElement(visual, "origin", xyz=words(finite_vector("com", payload.com, 3)))
    geometry = ET.SubElement(visual, "geometry")
    ET.SubElement(geometry, "sphere", radius=repr(payload.ball_radius))
    material = ET.SubElement(visual, "material", name="payload_steel")
    ET.SubElement(material, "color", rgba="0.16 0.44 0.72 1")
    joint = ET.SubElement(tree.robot, "joint", name=f"{name}_joint", type="fixed")
    ET.SubElement(joint, "parent", link=frame)
    ET.SubElement(joint, "child", link=name)
    return name


def payload_masses(tree: UrdfTree) -> dict[str, float]:
    """Return the mass of each payload on an arm [kg], by the name of its link."""
    masses = {}
    for name, link in tree.links.items():
        mass = link.find("inertial/mass") if name.startswith(PREFIX) else None
        if mass is not None:
            masses[name] = float(mass.get("value", "0"))
    return masses
