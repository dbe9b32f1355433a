"""Differences and sums of configurations, joint by joint: what `arm.difference` does, for C.

A revolute or prismatic joint has one coordinate, and a continuous one the cosine and sine of its
angle. The kernels do as Pinocchio does, so that both agree where a pair is not quite on the circle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fotsmc_pin.compiled import kernel
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.export.values import Scalar

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.export.program import Program


@kernel
def turned(c0: float, s0: float, c1: float, s1: float) -> float:
    """Angle from the pair `(c0, s0)` of cosine and sine to `(c1, s1)` [rad], within ±π."""
    cosine, sine = c0 * c1 + s0 * s1, c0 * s1 - s0 * c1
    if cosine > 1.0:
        return 0.0
    if cosine < -1.0:
        return math.pi if sine >= 0.0 else -math.pi
    if cosine > 1.0 - 0.5e-2:
        return math.asin(min(max(sine, -1.0), 1.0))
    angle = math.acos(cosine)
    return angle if sine >= 0.0 else -angle


@kernel
def turned_on(c: float, s: float, angle: float) -> tuple[float, float]:
    """Cosine and sine after a turn by `angle` [rad]."""
    cosine, sine = math.cos(angle), math.sin(angle)
    turned_c, turned_s = cosine * c - sine * s, sine * c + cosine * s
    # Back onto the circle, to first order.
    scale = (3.0 - (turned_c * turned_c + turned_s * turned_s)) / 2.0
    return turned_c * scale, turned_s * scale


@kernel
def is_round(c: float, s: float, roundness: float) -> bool:
    """Whether a pair of cosine and sine lies on the unit circle."""
    return abs(math.sqrt(c * c + s * s) - 1.0) <= roundness


@dataclass(frozen=True)
class Joint:
    """Where a joint's numbers stand.

    Attributes:
        q: first place in the configuration.
        v: place in the velocity.
        turns_on: whether it is continuous.
    """

    q: int
    v: int
    turns_on: bool


def joints_of(arm: Arm) -> list[Joint]:
    """Return the joints of an arm.

    Raises:
        ArgumentError: a joint that is neither revolute, prismatic nor continuous.
    """
    found = []
    for k, joint in enumerate(arm.model.joints[1:], 1):
        if joint.nv != 1 or joint.nq > 2:
            name = arm.model.names[k]
            remedy = f"joint {name} is a {joint.shortname()}; lock it: C knows one axis per joint"
            raise ArgumentError("controller", arm.name, remedy)
        found.append(Joint(joint.idx_q, joint.idx_v, joint.nq == 2))
    return found


class Turning:
    """Writes what a configuration needs that is no plain vector.

    Attributes:
        used: translated functions that were needed.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        self.used: list[str] = []

    def round_checks(self, joints: Sequence[Joint], q: str, roundness: float) -> list[str]:
        """Return conditions under which the pairs of `q` lie on the unit circle."""
        name = self._named(is_round, 3, joints)
        limit = self._program.dialect.number(roundness)
        pairs = [joint.q for joint in joints if joint.turns_on]
        return [f"{name}(({q})[{k}], ({q})[{k + 1}], {limit})" for k in pairs]

    def difference(self, joints: Sequence[Joint], q0: str, q1: str, target: str) -> list[str]:
        """Return assignments of `q1 ⊖ q0` to `target`."""
        name = self._named(turned, 4, joints)
        lines = []
        for joint in joints:
            k = joint.q
            value = f"({q1})[{k}] - ({q0})[{k}]"
            if joint.turns_on:
                value = f"{name}(({q0})[{k}], ({q0})[{k + 1}], ({q1})[{k}], ({q1})[{k + 1}])"
            lines.append(f"{target}[{joint.v}] = {value};")
        return lines

    def sum(self, joints: Sequence[Joint], q: str, way: str, target: str) -> list[str]:
        """Return assignments of `q ⊕ way` to `target`."""
        name = self._named(turned_on, 3, joints)
        lines = []
        for joint in joints:
            k = joint.q
            if not joint.turns_on:
                lines.append(f"{target}[{k}] = {q}[{k}] + {way}[{joint.v}];")
                continue
            pair = self._program.tuple_type(("real", "real"))
            lines += [
                f"const {pair} pair_{k} = {name}({q}[{k}], {q}[{k + 1}], {way}[{joint.v}]);",
                f"{target}[{k}] = pair_{k}.r0;",
                f"{target}[{k + 1}] = pair_{k}.r1;",
            ]
        return lines

    def _named(self, kernel: Any, arguments: int, joints: Sequence[Joint]) -> str:
        if not any(joint.turns_on for joint in joints):
            return ""
        reals = [Scalar("real", f"x{k}") for k in range(arguments)]
        function = self._program.function(kernel, reals, caller=None, node=None)
        if function.name not in self.used:
            self.used.append(function.name)
        return function.name
