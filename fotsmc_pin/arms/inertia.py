"""Inertia of a link: mass, centre of mass and rotational inertia, in and out of a URDF."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.arms.tree import UrdfTree
    from fotsmc_pin.types import Array


ENTRIES = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))


@dataclass(frozen=True, kw_only=True, eq=False)
class LinkInertia:
    """Inertia of one link.

    Attributes:
        mass: [kg].
        com: centre of mass in the link's frame, (3,) [m].
        rpy: roll, pitch and yaw of the axes of `about_com` against the link's frame, (3,) [rad].
        about_com: rotational inertia about the centre of mass, (3, 3) [kg·m²].
    """

    mass: float
    com: Array
    rpy: Array
    about_com: Array

    @property
    def second_moments(self) -> Array:
        """Principal second moments of mass `∫ x² dm` about the centre of mass, (3,) [kg·m²].

        They are `½ tr(I) - λ(I)`. A body of real matter has none below zero, which is the
        triangle inequality of its principal moments of inertia.
        """
        moments = np.linalg.eigvalsh(self.about_com)
        return np.asarray(0.5 * moments.sum() - moments)

    def is_consistent(self, tolerance: float = 1e-9) -> bool:
        """Whether matter with this inertia can exist; `tolerance` is relative to the trace."""
        slack = tolerance * abs(float(np.trace(self.about_com)))
        return self.mass >= 0.0 and bool(np.all(self.second_moments >= -slack))

    def made_consistent(self) -> LinkInertia:
        """Return the inertia with the negative second moments of mass raised to zero."""
        trace = float(np.trace(self.about_com))
        moments, axes = np.linalg.eigh(0.5 * trace * np.eye(3) - self.about_com)
        covariance = (axes * np.maximum(moments, 0.0)) @ axes.T
        about_com = np.trace(covariance) * np.eye(3) - covariance
        return LinkInertia(
            mass=self.mass, com=self.com, rpy=self.rpy, about_com=0.5 * (about_com + about_com.T)
        )


def read_inertia(tree: UrdfTree, link: str) -> LinkInertia | None:
    """Return the inertia of a link, None where the file gives none.

    Raises:
        UrdfError: negative mass, or entries that are missing or no finite numbers.
    """
    inertial = tree.links[link].find("inertial")
    if inertial is None:
        return None
    where = f"link {link!r}"
    mass_tag = inertial.find("mass")
    if mass_tag is None or mass_tag.get("value") is None:
        raise tree.fail(f"{where}: <inertial> has no <mass value=...>")
    (mass,) = tree.numbers(mass_tag, "value", (0.0,), where)
    if mass < 0.0:
        raise tree.fail(f"{where}: mass {mass:g} kg is negative")
    origin, matrix = inertial.find("origin"), inertial.find("inertia")
    about_com = np.zeros((3, 3))
    for name, row, column in ENTRIES:
        if matrix is None or matrix.get(name) is None:
            raise tree.fail(f'{where}: its <inertial> has no <inertia {name}="...">')
        (entry,) = tree.numbers(matrix, name, (0.0,), where)
        about_com[row, column] = about_com[column, row] = entry
    return LinkInertia(
        mass=mass,
        com=np.array(tree.numbers(origin, "xyz", (0.0, 0.0, 0.0), where)),
        rpy=np.array(tree.numbers(origin, "rpy", (0.0, 0.0, 0.0), where)),
        about_com=about_com,
    )


def write_inertia(link: ET.Element, inertia: LinkInertia) -> None:
    """Set the `<inertial>` of a link."""
    inertial = link.find("inertial")
    if inertial is None:
        inertial = ET.SubElement(link, "inertial")
    parts = {}
    for tag in ("origin", "mass", "inertia"):
        found = inertial.find(tag)
        parts[tag] = ET.SubElement(inertial, tag) if found is None else found
    parts["origin"].set("xyz", words(inertia.com))
    parts["origin"].set("rpy", words(inertia.rpy))
    parts["mass"].set("value", repr(float(inertia.mass)))
    for name, row, column in ENTRIES:
        parts["inertia"].set(name, repr(float(inertia.about_com[row, column])))


def words(vector: Array) -> str:
    """Return numbers as a URDF attribute, every digit kept."""
    return " ".join(repr(float(value)) for value in vector)


def moving_mass(tree: UrdfTree) -> float:
    """Return the mass that the joints move [kg], which every one of them must have.

    Raises:
        UrdfError: a moving joint carries a body (a link and what is fixed to it) without mass,
            or the file has no moving joint.
    """
    if not tree.moving_joints:
        raise tree.fail("no joint moves; keep at least one free")
    inertias = {link: read_inertia(tree, link) for link in tree.links}
    total = 0.0
    for joint in tree.moving_joints:
        bodies = [inertias[link] for link in tree.rigid_body(joint.child)]
        mass = sum(body.mass for body in bodies if body is not None)
        if mass == 0.0:
            problem = "has no <inertial>" if all(body is None for body in bodies) else "has no mass"
            raise tree.fail(
                f"link {joint.child!r}, moved by joint {joint.name!r}, {problem}; "
                "give it a positive mass and an inertia, or lock the joint"
            )
        total += mass
    return total
