"""`PosePath`: where a frame goes, apart from when; a line, an arc, a screw, waypoints.

A path is a pose `T(s)` of one number `s` from 0 to 1, with its twist `ξ = (T⁻¹ dT/ds)^∨` and the
derivative of that, linear part first, in the axes of `T`. With a time law `s(t)` it is a reference:
`V = ξ ṡ`, `A = dξ/ds ṡ² + ξ s̈`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array

STRAIGHT = 1e-6
"""How far the columns of a rotation may be from orthonormal."""
SAME = 1e-9
"""Length of a line below which its ends are the same [m]."""
HALF_TURN = 3.1
"""Angle between two orientations from which on the way from one to the other is no clear one."""


def pose_of(name: str, value: Any) -> pin.SE3:
    """Return a pose, an `SE3` or a matrix (4, 4), as an `SE3` of its own.

    Raises:
        ArgumentError: it is neither, not finite, or its rotation is none.
    """
    matrix = value.homogeneous if isinstance(value, pin.SE3) else value
    matrix = checks.finite_array(name, matrix, (4, 4))
    R = matrix[:3, :3]
    if np.abs(R.T @ R - np.eye(3)).max() > STRAIGHT or np.linalg.det(R) < 0.0:
        raise ArgumentError(name, matrix.tolist(), "its rotation is none: normalize it")
    return pin.SE3(R, matrix[:3, 3])


def turned(name: str, start: pin.SE3, end: pin.SE3) -> Array:
    """Return the rotation vector (3,) [rad] from one orientation to another, in its own axes.

    Raises:
        ArgumentError: they are half a turn apart, so that there is no shortest way.
    """
    turn: Array = pin.log3(start.rotation.T @ end.rotation)
    if np.linalg.norm(turn) > HALF_TURN:
        raise ArgumentError(name, end, "half a turn apart: put a pose between them")
    return turn


class PosePath(ABC):
    """The way of a frame."""

    @abstractmethod
    def at(self, s: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,), by `s` from 0 to 1."""


def of_parts(
    R: Array, p: Array, dp: Array, ddp: Array, w: Array, dw: Array
) -> tuple[pin.SE3, Array, Array]:
    """Return pose, twist and derivative from the way in the world and the turning in own axes."""
    v = R.T @ dp
    return (
        pin.SE3(R, p),
        np.concatenate([v, w]),
        np.concatenate([R.T @ ddp - np.cross(w, v), dw]),
    )


@dataclass(frozen=True)
class BetweenPoses(PosePath):
    """A path from one pose to another, less than half a turn apart.

    Attributes:
        start: pose at `s = 0`.
        end: pose at `s = 1`.
    """

    start: pin.SE3
    end: pin.SE3

    def __post_init__(self) -> None:
        """Check the poses."""
        object.__setattr__(self, "start", pose_of("start", self.start))
        object.__setattr__(self, "end", pose_of("end", self.end))
        _ = self._turn

    @cached_property
    def _turn(self) -> Array:
        return turned("end", self.start, self.end)


@dataclass(frozen=True)
class PoseLine(BetweenPoses):
    """The origin on a straight line, while the frame turns evenly about one axis.

    Attributes:
        start: pose at `s = 0`.
        end: pose at `s = 1`.
    """

    def at(self, s: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,), by `s` from 0 to 1."""
        way, zero = self.end.translation - self.start.translation, np.zeros(3)
        R = self.start.rotation @ pin.exp3(s * self._turn)
        return of_parts(R, self.start.translation + s * way, way, zero, self._turn, zero)


@dataclass(frozen=True)
class PoseScrew(BetweenPoses):
    """The shortest motion on SE(3): `T(s) = T_0 exp(s log(T_0⁻¹ T_1))`, one screw all the way.

    Attributes:
        start: pose at `s = 0`.
        end: pose at `s = 1`.
    """

    @cached_property
    def _twist(self) -> Array:
        return np.array(pin.log6(self.start.inverse() * self.end).vector)

    def at(self, s: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,), by `s` from 0 to 1."""
        pose = self.start * pin.exp6(pin.Motion(s * self._twist))
        return pose, self._twist.copy(), np.zeros(6)


@dataclass(frozen=True)
class PoseArc(PosePath):
    """The origin on an arc about an axis in space.

    Attributes:
        start: pose at `s = 0`.
        center: a point of the axis (3,) [m].
        axis: direction of the axis (3,), of any length.
        angle: how far it goes [rad]; more than a turn goes round more than once.
        turning: whether the frame turns with the arc, or keeps its orientation.
    """

    start: pin.SE3
    center: ArrayLike
    axis: ArrayLike
    angle: float = 2.0 * np.pi
    turning: bool = False

    def __post_init__(self) -> None:
        """Check the numbers."""
        object.__setattr__(self, "start", pose_of("start", self.start))
        object.__setattr__(self, "center", checks.finite_vector("center", self.center, 3))
        axis = checks.finite_vector("axis", self.axis, 3)
        size = float(np.linalg.norm(axis))
        if size == 0.0:
            raise ArgumentError("axis", self.axis, "give a direction")
        object.__setattr__(self, "axis", axis / size)
        object.__setattr__(self, "angle", checks.finite_number("angle", self.angle))

    def at(self, s: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,), by `s` from 0 to 1."""
        center, axis, zero = np.asarray(self.center), np.asarray(self.axis), np.zeros(3)
        turn = pin.exp3(s * self.angle * axis)
        arm = turn @ (self.start.translation - center)
        dp = self.angle * np.cross(axis, arm)
        ddp = self.angle * np.cross(axis, dp)
        if not self.turning:
            return of_parts(self.start.rotation, center + arm, dp, ddp, zero, zero)
        w = self.start.rotation.T @ (self.angle * axis)
        return of_parts(turn @ self.start.rotation, center + arm, dp, ddp, w, zero)


@dataclass(frozen=True)
class PoseWaypoints(PosePath):
    """Lines from pose to pose, with the corners rounded.

    Within `blend` of a pose the way goes over from one line to the next, `p + d_0 r + (d_1 - d_0)
    b(r)`, with a ramp `b` whose second derivative is continuous; the orientation likewise. It
    passes a corner at 5/32 of the blend times the change of direction.

    Attributes:
        poses: at least two.
        blend: how far before and behind a pose a corner is rounded [m]; at most half a line.
        length: what a radian counts as where lines are measured [m].
    """

    poses: Sequence[pin.SE3]
    blend: float = 0.02
    length: float = 0.1
    _ends: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Check the poses, and measure the lines."""
        poses = [pose_of(f"poses[{k}]", pose) for k, pose in enumerate(self.poses)]
        if len(poses) < 2:
            raise ArgumentError("poses", self.poses, "give at least two")
        object.__setattr__(self, "poses", tuple(poses))
        blend = checks.finite_number("blend", self.blend, above=0.0)
        length = checks.finite_number("length", self.length, above=0.0)
        sizes = []
        for k, (one, two) in enumerate(pairwise(poses)):
            turn = turned(f"poses[{k + 1}]", one, two)
            way = two.translation - one.translation
            sizes.append(float(np.hypot(np.linalg.norm(way), length * np.linalg.norm(turn))))
        if min(sizes) < SAME:
            raise ArgumentError("poses", self.poses, "two in a row are the same: leave one out")
        object.__setattr__(self, "blend", min(blend, 0.5 * min(sizes)))
        object.__setattr__(self, "_ends", np.cumsum([0.0, *sizes]))

    def at(self, s: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,), by `s` from 0 to 1."""
        total = float(self._ends[-1])
        r = s * total
        line = int(
            np.clip(np.searchsorted(self._ends, r, side="right") - 1, 0, len(self._ends) - 2)
        )
        near = line if r - self._ends[line] < self._ends[line + 1] - r else line + 1
        if 0 < near < len(self._ends) - 1 and abs(r - self._ends[near]) < self.blend:
            return self._corner(near, r - self._ends[near], total)
        p, w = self._rates(line)
        start, along = self.poses[line], r - self._ends[line]
        R = start.rotation @ pin.exp3(along * w)
        zero = np.zeros(3)
        return of_parts(R, start.translation + along * p, total * p, zero, total * w, zero)

    def _rates(self, line: int) -> tuple[Array, Array]:
        """Return way and turn per length of a line."""
        one, two = self.poses[line], self.poses[line + 1]
        size = self._ends[line + 1] - self._ends[line]
        turn = pin.log3(one.rotation.T @ two.rotation)
        return (two.translation - one.translation) / size, turn / size

    def _corner(self, k: int, r: float, total: float) -> tuple[pin.SE3, Array, Array]:
        """Return what `at` does at the distance `r` from the pose `k`, inside its blend."""
        (p0, w0), (p1, w1), corner = self._rates(k - 1), self._rates(k), self.poses[k]
        u = 0.5 * (r / self.blend + 1.0)
        ramp = 2.0 * self.blend * u**4 * (2.5 - 3.0 * u + u * u)
        slope = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
        bend = 15.0 * u * u * (1.0 - u) ** 2 / self.blend
        after = pin.exp3(ramp * w1)
        R = corner.rotation @ pin.exp3((r - ramp) * w0) @ after
        before, turning = after.T @ w0, slope * w1
        w = before * (1.0 - slope) + turning
        dw = -before * bend + w1 * bend - np.cross(turning, before * (1.0 - slope))
        p = corner.translation + p0 * r + (p1 - p0) * ramp
        dp, ddp = p0 + (p1 - p0) * slope, (p1 - p0) * bend
        return of_parts(R, p, total * dp, total**2 * ddp, total * w, total**2 * dw)
