"""References of poses: a path with a time law, a pose to hold, a swing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.poses.inverse import Kinematics, configurations_along
from fotsmc_pin.references.poses.path import PosePath, of_parts, pose_of
from fotsmc_pin.references.sinusoid import fade_in
from fotsmc_pin.references.time_scaling import motion_limits

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

KNOTS = 201
"""Places of a path at which its limits are looked at."""
LONGEST = 1e3
"""Time above which a motion is not planned [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseMotion:
    """A path from rest to rest: `t -> (T, V, A)`.

    `s` is a ramp of its speed up, an even speed, and a ramp down: `ṡ` goes over by the quintic
    `10 u³ - 15 u⁴ + 6 u⁵`, so that `s̈` and its rate are continuous. Where nothing is cruised it is
    about as smooth as a motion of minimum jerk; `minimum_jerk` takes that itself, `s = 10 u³ -
    15 u⁴ + 6 u⁵` over the whole time. Before its start and after its end it rests.

    Attributes:
        path: where it goes.
        duration: how long it takes [s].
        cruise: share of the time at even speed, from 0 to below 1; None for minimum jerk.
        q_start: configuration from which it starts (nq,), where it was planned for an arm.
    """

    path: PosePath
    duration: float
    cruise: float | None = None
    q_start: Array | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        checks.instance("path", self.path, PosePath, "give a PoseLine, PoseArc, ...")
        checks.finite_number("duration", self.duration, above=0.0)
        if self.cruise is not None:
            checks.finite_number("cruise", self.cruise, at_least=0.0, below=1.0)

    def __call__(self, t: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,) at time `t` [s]."""
        s, ds, dds = progress(min(max(t / self.duration, 0.0), 1.0), self.cruise)
        pose, twist, slope = self.path.at(s)
        rate = ds / self.duration
        return pose, twist * rate, slope * rate**2 + twist * (dds / self.duration**2)

    @classmethod
    def timed(
        cls,
        path: PosePath,
        arm: Arm,
        *,
        q: ArrayLike | None = None,
        frame: str | None = None,
        speed: float = 0.25,
        acceleration: float = 1.0,
        angular_speed: float = 1.0,
        angular_acceleration: float = 4.0,
        velocity_limit: ArrayLike | None = None,
        acceleration_limit: ArrayLike | None = None,
        cruise: float | None = None,
    ) -> PoseMotion:
        """Plan the shortest time within Cartesian and joint limits.

        They are looked at in 201 places of the path; the configurations there are found from `q`
        by Newton's method.

        Args:
            path: where to go.
            arm: the arm.
            q: configuration near the start (nq,); `arm.neutral` by default.
            frame: frame that goes; the tool frame by default.
            speed: of the frame's origin [m/s].
            acceleration: of the frame's origin [m/s²].
            angular_speed: [rad/s].
            angular_acceleration: [rad/s²].
            velocity_limit: of the joints, scalar or (nv,) [rad/s, m/s]; 0.8 of the arm's if None.
            acceleration_limit: of the joints, scalar or (nv,) [rad/s², m/s²]; none by default.
            cruise: as the attribute.

        Raises:
            ArgumentError: the frame cannot follow, with the place; or a number out of its bounds.
        """
        demand_arm(arm)
        near = arm.neutral if q is None else checks.finite_vector("q", q, arm.nq)
        limits = [
            checks.finite_number(name, value, above=0.0)
            for name, value in (
                ("speed", speed),
                ("acceleration", acceleration),
                ("angular_speed", angular_speed),
                ("angular_acceleration", angular_acceleration),
            )
        ]
        allowed = 0.8 * arm.velocity_limit if velocity_limit is None else velocity_limit
        velocity, most = motion_limits(arm, allowed if np.isfinite(allowed).all() else None,
                                       acceleration_limit)  # fmt: skip
        body = pin.FrameType.BODY
        index = arm.tool_frame_id if frame is None else arm.model.getFrameId(frame, body)
        if index >= arm.model.nframes:
            raise ArgumentError("frame", frame, "the arm has no frame of that name")
        kinematics = Kinematics(arm, index)
        moments = np.linspace(0.0, 1.0, KNOTS)
        rows = [progress(u, cruise) for u in moments.tolist()]
        places = [path.at(s) for s, _, _ in rows]
        qs = configurations_along(kinematics, (place[0] for place in places), near, "path")
        shortest = 0.0
        for (_, ds, dds), (pose, twist, slope), place in zip(rows, places, qs, strict=True):
            R, J = pose.rotation, kinematics.jacobian(place)
            inverse = np.linalg.pinv(J)
            along = inverse @ twist
            bend = inverse @ (slope - kinematics.drift(place, along))
            V, A = twist * ds, slope * ds**2 + twist * dds
            world = R @ (A[:3] + np.cross(V[3:], V[:3]))
            first = [
                np.linalg.norm(V[:3]) / limits[0],
                np.linalg.norm(V[3:]) / limits[2],
                *(np.abs(along * ds) / velocity),
            ]
            second = [
                np.linalg.norm(world) / limits[1],
                np.linalg.norm(A[3:]) / limits[3],
                *(np.abs(bend * ds**2 + along * dds) / most),
            ]
            shortest = max(shortest, float(max(first)), float(np.sqrt(max(second))))
        if not 0.0 < shortest < LONGEST:
            remedy = f"it takes {shortest:.3g} s: give a path that moves, away from singularities"
            raise ArgumentError("path", path, remedy)
        return cls(path=path, duration=shortest, cruise=cruise, q_start=qs[0])


def progress(u: float, cruise: float | None) -> tuple[float, float, float]:
    """Return `s`, `ds/du` and `d²s/du²` at the share `u` of the time."""
    if cruise is None:
        return (
            u**3 * (10.0 - 15.0 * u + 6.0 * u * u),
            30.0 * u * u * (1.0 - u) ** 2,
            60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
        )
    ramp = 0.5 * (1.0 - cruise)
    top = 1.0 / (1.0 - ramp)
    if u > 1.0 - ramp:
        s, ds, dds = progress(1.0 - u, cruise)
        return 1.0 - s, ds, -dds
    if u >= ramp:
        return top * (u - 0.5 * ramp), top, 0.0
    x = u / ramp
    return (
        top * ramp * x**4 * (2.5 - 3.0 * x + x * x),
        top * x**3 * (10.0 - 15.0 * x + 6.0 * x * x),
        top / ramp * 30.0 * x * x * (1.0 - x) ** 2,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseHold:
    """One pose at rest: `t -> (T, 0, 0)`.

    Attributes:
        pose: the pose.
        q_start: configuration from which a run starts (nq,), where one is known.
    """

    pose: pin.SE3
    q_start: Array | None = None

    def __post_init__(self) -> None:
        """Check the pose."""
        object.__setattr__(self, "pose", pose_of("pose", self.pose))

    def __call__(self, t: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, and rest."""
        return self.pose, np.zeros(6), np.zeros(6)


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseSwing:
    """A circle of the origin about `center`, while the frame swings about an axis of its own.

        p = p_c + g(t) R_c r (cos ωt, sin ωt, ½ sin 2ωt),   R = R_c exp(g(t) θ sin(ω t / √2) a)

    `g` fades the motion in, so that it begins at rest in the middle.

    Attributes:
        center: pose in the middle.
        radius: `r` [m].
        angle: `θ` [rad].
        axis: `a`, in the frame's axes (3,).
        rate: `ω` [rad/s].
        fade: time in which it is faded in [s].
        q_start: configuration from which a run starts (nq,), where one is known.
    """

    center: pin.SE3
    radius: float = 0.08
    angle: float = 0.25
    axis: tuple[float, float, float] = (0.6, 0.48, 0.64)
    rate: float = 2.0
    fade: float = 1.0
    q_start: Array | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        object.__setattr__(self, "center", pose_of("center", self.center))
        for name in ("radius", "angle"):
            checks.finite_number(name, getattr(self, name), at_least=0.0)
        for name in ("rate", "fade"):
            checks.finite_number(name, getattr(self, name), above=0.0)
        axis = checks.finite_vector("axis", self.axis, 3)
        object.__setattr__(self, "axis", tuple((axis / np.linalg.norm(axis)).tolist()))

    def __call__(self, t: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,) at time `t` [s]."""
        w, a, r = self.rate, np.array(self.axis), self.radius
        c, s, c2, s2 = np.cos(w * t), np.sin(w * t), np.cos(2 * w * t), np.sin(2 * w * t)
        x = r * np.array([c, s, 0.5 * s2])
        dx = r * w * np.array([-s, c, c2])
        ddx = r * w * w * np.array([-c, -s, -2.0 * s2])
        slow = w / np.sqrt(2.0)
        turn, dturn, ddturn = (
            self.angle * np.sin(slow * t),
            self.angle * slow * np.cos(slow * t),
            -self.angle * slow**2 * np.sin(slow * t),
        )
        g, dg, ddg = fade_in(max(t, 0.0), self.fade)
        R_c, p_c = self.center.rotation, self.center.translation
        R = R_c @ pin.exp3(g * turn * a)
        return of_parts(
            R,
            p_c + R_c @ (g * x),
            R_c @ (g * dx + dg * x),
            R_c @ (g * ddx + 2.0 * dg * dx + ddg * x),
            (g * dturn + dg * turn) * a,
            (g * ddturn + 2.0 * dg * dturn + ddg * turn) * a,
        )
