"""A URDF as a tree of links and joints by name, checked for what dynamics need."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.errors import UrdfError

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Iterator

MOVING_TYPES = ("revolute", "continuous", "prismatic")
REFUSED_TYPES = {
    "floating": "a free base needs a law that handles six unactuated directions",
    "planar": "a planar joint has three degrees of freedom and no law here handles it yet",
    "spherical": "a ball joint has no angle to control and no law here handles it yet",
    "ball": "a ball joint has no angle to control and no law here handles it yet",
}


@dataclass(frozen=True)
class Joint:
    """One `<joint>` element, and the links that it connects."""

    element: ET.Element
    name: str
    type: str
    parent: str
    child: str

    @property
    def moves(self) -> bool:
        """Whether the joint has a degree of freedom."""
        return self.type in MOVING_TYPES


def plain_float(text: str) -> float:
    """Return the number that C and Python both read; Python alone reads `1_000` and `１`."""
    if "_" in text or not text.isascii():
        raise ValueError(text)
    return float(text)


class UrdfTree:
    """Links and joints of a `<robot>` element.

    Attributes:
        robot: the `<robot>` element.
        origin: what to call the file in messages.
        links: `<link>` elements by name.
        joints: joints by name, in the order of the file.
        root: name of the base link.

    Raises:
        UrdfError: duplicate or missing names, a link that no joint or two joints carry, a loop,
            or a joint type without a law.
    """

    def __init__(self, robot: ET.Element, origin: str) -> None:
        """Read names and connections; refuse what is no tree."""
        self.robot, self.origin = robot, origin
        self.links = self._named("link")
        elements = self._named("joint")
        self.joints = {name: self._joint(name, element) for name, element in elements.items()}
        self._joint_above: dict[str, Joint] = {}
        self._joints_below: dict[str, list[Joint]] = {name: [] for name in self.links}
        for joint in self.joints.values():
            self._hang(joint)
        self.root = self._find_root()

    def fail(self, message: str) -> UrdfError:
        """Return an error that names the file."""
        return UrdfError(f"{self.origin}: {message}")

    def joint_above(self, link: str) -> Joint | None:
        """Return the joint that carries a link, None for the base."""
        return self._joint_above.get(link)

    def joints_below(self, link: str) -> tuple[Joint, ...]:
        """Return the joints that a link carries."""
        return tuple(self._joints_below[link])

    def chain(self, link: str) -> tuple[Joint, ...]:
        """Return the joints from the base to a link."""
        joints: list[Joint] = []
        while (joint := self._joint_above.get(link)) is not None:
            joints.append(joint)
            link = joint.parent
        return tuple(reversed(joints))

    def rigid_body(self, link: str) -> Iterator[str]:
        """Yield the link and all links that are rigidly fixed beyond it."""
        pending = [link]
        while pending:
            name = pending.pop()
            yield name
            pending += [joint.child for joint in self._joints_below[name] if not joint.moves]

    @property
    def moving_joints(self) -> tuple[Joint, ...]:
        """The joints with a degree of freedom, in the order of the file."""
        return tuple(joint for joint in self.joints.values() if joint.moves)

    def number(self, element: ET.Element | None, attribute: str, default: float, of: str) -> float:
        """Return a number of an element, `default` where it is not given.

        Raises:
            UrdfError: text that is no number, or NaN.
        """
        text = None if element is None else element.get(attribute)
        if text is None:
            return default
        try:
            value = plain_float(text)
        except ValueError:
            value = math.nan
        if math.isnan(value):
            tag = "" if element is None else element.tag
            raise self.fail(f'{of}: <{tag} {attribute}="{text}"> is not a number')
        return value

    def numbers(
        self, element: ET.Element | None, attribute: str, default: tuple[float, ...], of: str
    ) -> tuple[float, ...]:
        """Return the numbers of an attribute such as `xyz="0 0 1"`, finite and all there."""
        text = None if element is None else element.get(attribute)
        if text is None:
            return default
        try:
            values = tuple(plain_float(word) for word in text.split())
        except ValueError:
            values = ()
        if len(values) != len(default) or not all(math.isfinite(value) for value in values):
            tag = "" if element is None else element.tag
            wanted = "a finite number" if len(default) == 1 else f"{len(default)} finite numbers"
            raise self.fail(f'{of}: <{tag} {attribute}="{text}"> is not {wanted}')
        return values

    def _named(self, tag: str) -> dict[str, ET.Element]:
        elements = self.robot.findall(tag)
        names = [element.get("name") for element in elements]
        if None in names or "" in names:
            raise self.fail(f"a <{tag}> has no name")
        repeated = [str(name) for name, times in Counter(names).items() if times > 1]
        if repeated:
            raise self.fail(f"two <{tag}> elements are named {repeated[0]!r}; rename one")
        return {str(name): element for name, element in zip(names, elements, strict=True)}

    def _joint(self, name: str, element: ET.Element) -> Joint:
        kind = element.get("type", "")
        if kind in REFUSED_TYPES:
            raise self.fail(f"joint {name!r} is {kind}: {REFUSED_TYPES[kind]}")
        if kind != "fixed" and kind not in MOVING_TYPES:
            known = ", ".join(("fixed", *MOVING_TYPES))
            raise self.fail(f"joint {name!r} has type {kind!r}; choose one of {known}")
        ends = {}
        for tag in ("parent", "child"):
            end = element.find(tag)
            link = None if end is None else end.get("link")
            if link is None or link not in self.links:
                raise self.fail(f"joint {name!r}: its {tag} link {link!r} is not in the file")
            ends[tag] = link
        self._check_placement(element, name)
        return Joint(element=element, name=name, type=kind, **ends)

    def _check_placement(self, element: ET.Element, name: str) -> None:
        where = f"joint {name!r}"
        for attribute in ("xyz", "rpy"):
            self.numbers(element.find("origin"), attribute, (0.0, 0.0, 0.0), where)
        axis = self.numbers(element.find("axis"), "xyz", (1.0, 0.0, 0.0), where)
        if element.get("type") != "fixed" and math.hypot(*axis) < 1e-9:
            raise self.fail(f"{where}: its axis is zero; give a direction such as 0 0 1")

    def _hang(self, joint: Joint) -> None:
        if joint.child in self._joint_above:
            other = self._joint_above[joint.child].name
            raise self.fail(
                f"link {joint.child!r} hangs on two joints, {other!r} and {joint.name!r}; "
                "closed loops are not handled, open one of them"
            )
        self._joint_above[joint.child] = joint
        self._joints_below[joint.parent].append(joint)

    def _find_root(self) -> str:
        roots = [name for name in self.links if name not in self._joint_above]
        if not roots:
            what = "it has no link" if not self.links else "its joints form a loop, no link is base"
            raise self.fail(f"no base: {what}")
        if len(roots) > 1:
            raise self.fail(
                f"links {roots[0]!r} and {roots[1]!r} both have no joint above them; "
                "join them with a fixed joint or remove one"
            )
        reached, pending = set(), [roots[0]]
        while pending:
            name = pending.pop()
            reached.add(name)
            pending += [joint.child for joint in self._joints_below[name]]
        lost = [name for name in self.links if name not in reached]
        if lost:
            raise self.fail(f"link {lost[0]!r} is in a loop of joints that the base does not reach")
        return roots[0]
