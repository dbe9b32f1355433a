"""Courses: what an arm is to do in a scenario, and in which spans of time it is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.references import Hold, Quintic, Sinusoid, broken_limits
from fotsmc_pin.references.sinusoid import fade_in

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, Reference

SINE_TIME, HOLD_TIME, HALT_TIME = 6.0, 20.0, 12.0
"""Simulated time of a sinusoid, of a hold, and of a sinusoid that comes to a halt [s]."""
MOVE_SIZE = 0.5
"""Largest distance of a joint from the middle pose [rad, m]."""
MOVE_SPEED, MOVE_ACCELERATION = 1.0, 4.0
"""Largest speed [rad/s, m/s] and acceleration [rad/s², m/s²] of a move."""
SPEED_SHARE, EFFORT_SHARE = 0.5, 0.8
"""Shares of the arm's velocity limits, and of its effort limits as the true arm needs them."""
FIRST_DWELL, DWELL = 2.0, 3.0
"""Rest before the first move, in which the start error goes, and after each move [s]."""
CANDIDATES, TRIED, EASY = 300, 30, 0.5
"""Random poses drawn, how many of them are tried, and the share of an effort limit that is easy."""
SMALLEST_SHRINKING = 0.05
"""Share of the moves' size from which on they are not made smaller to spare effort."""


class Rest(NamedTuple):
    """A span in which the reference stands still."""

    start: float
    """When it comes to a stand [s]."""
    end: float
    """When it goes on [s]."""
    move_start: float | None = None
    """When the move began that ends here [s]; None where there was none from rest to rest."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """A reference, and where a run of it is judged.

    Attributes:
        reference: `t -> (q_d, v_d, a_d)`.
        duration: simulated time [s].
        judged: span in which the tracking error counts [s].
        rests: spans in which the reference stands still.
        text: what the arm is to do, in a sentence.
    """

    reference: Reference
    duration: float
    judged: tuple[float, float]
    rests: tuple[Rest, ...] = ()
    text: str = ""


def sine(arm: Arm, duration: float = SINE_TIME) -> Course:
    """Return sinusoids in every joint inside the arm's limits; the last half is judged."""
    return Course(
        reference=Sinusoid.inside_limits(arm),
        duration=duration,
        judged=(0.5 * duration, duration),
        text=f"follow a sinusoid in each joint for {duration:g} s",
    )


def hold(arm: Arm, true: Arm, duration: float = HOLD_TIME) -> Course:
    """Return one pose to hold, the first that `moves` goes to; the last half is judged.

    Args:
        arm: the nominal arm.
        true: the arm that moves, whose efforts count.
        duration: simulated time [s].
    """
    pose = arm.from_joint_positions(_poses(arm, true)[1])
    share = float(np.max(np.abs(true.gravity(pose)) / true.effort_limit))
    return Course(
        reference=Hold(arm, pose),
        duration=duration,
        judged=(0.5 * duration, duration),
        rests=(Rest(0.0, duration),),
        text=f"hold one pose for {duration:g} s; its gravity takes {100.0 * share:.0f} % of an "
        "effort limit",
    )


def moves(arm: Arm, true: Arm, *, first_dwell: float = FIRST_DWELL, dwell: float = DWELL) -> Course:
    """Return three moves from pose to pose, with a rest before the first and after each.

    A move is a quintic from rest to rest in all joints at once. It takes at most half of each
    velocity limit, 1 rad/s and 4 rad/s². The poses lie up to 0.5 rad around a middle one, within
    the position limits. That is the centre of `Sinusoid.inside_limits`, or, where the true arm
    would need more than 80 % of an effort limit, the nearest of a fixed set of random poses where
    it does not. Where none is found the moves are smaller.

    Args:
        arm: the nominal arm.
        true: the arm that moves, whose efforts count.
        first_dwell: rest before the first move [s].
        dwell: rest after each move [s].
    """
    poses = _poses(arm, true)
    middle, first, second = (arm.from_joint_positions(x) for x in poses)
    plain = _path(arm, [middle, first, second, middle])
    lasts = np.diff(plain.breaks)
    waypoints, times, rests = [middle, middle], [0.0, first_dwell], []
    for pose, length in zip((first, second, middle), lasts.tolist(), strict=True):
        begins, stops = times[-1], times[-1] + length
        waypoints += [pose, pose]
        times += [stops, stops + dwell]
        rests.append(Rest(stops, stops + dwell, begins))
    sizes = np.abs(np.diff(poses[[0, 1, 2, 0]], axis=0)).max(axis=1)
    return Course(
        reference=Quintic.through(arm, np.array(waypoints), times=times),
        duration=times[-1],
        judged=(first_dwell, times[-1]),
        rests=tuple(rests),
        text="make three moves from rest to rest, of "
        + ", ".join(f"{size:.2g}" for size in sizes)
        + " rad in "
        + ", ".join(f"{length:.2g}" for length in lasts)
        + f" s, after {first_dwell:g} s of rest and with {dwell:g} s after each",
    )


def sine_to_a_halt(arm: Arm, duration: float = HALT_TIME) -> Course:
    """Return the sinusoids of `sine`, faded out in mid-run, and rest from there on.

    They run for the first half, whose last half is judged: with 12 s that is the same motion and
    the same span as in `sine`. They fade out within a sixth, and the last third is rest.

    Args:
        arm: the nominal arm.
        duration: simulated time [s].
    """
    fades, stops = 0.5 * duration, 2.0 / 3.0 * duration
    reference = FadingOut(Sinusoid.inside_limits(arm), begin=fades, end=stops)
    return Course(
        reference=reference,
        duration=duration,
        judged=(0.25 * duration, fades),
        rests=(Rest(stops, duration),),
        text=f"follow a sinusoid in each joint for {fades:g} s, fade out within "
        f"{stops - fades:g} s and rest for {duration - stops:g} s",
    )


@dataclass(frozen=True)
class FadingOut:
    """A sinusoid that fades out to rest at its centre: `x(t) = g(t) · x_sinusoid(t)`.

    `g` falls from 1 to 0 by a quintic, so that position, velocity and acceleration are continuous.

    Attributes:
        sinusoid: what fades out.
        begin: when it begins to [s].
        end: when it has [s].
    """

    sinusoid: Sinusoid
    begin: float
    end: float

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s]."""
        arm, center = self.sinusoid.arm, self.sinusoid.center
        q_d, v_d, a_d = self.sinusoid(t)
        if t <= self.begin:
            return q_d, v_d, a_d
        x = arm.difference(center, q_d)
        # Backwards in time it is a fade-in: the odd derivative changes its sign.
        g, back, g_dd = fade_in(max(self.end - t, 0.0), self.end - self.begin)
        return (
            arm.integrate(center, g * x),
            g * v_d - back * x,
            g * a_d - 2.0 * back * v_d + g_dd * x,
        )

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return `q_d` (N, nq), `v_d` and `a_d` (N, nv) at the times `t` (N,) [s]."""
        if t[-1] <= self.begin:
            return self.sinusoid.at(t)
        q_d, v_d, a_d = zip(*(self(moment) for moment in t.tolist()), strict=True)
        return np.array(q_d), np.array(v_d), np.array(a_d)


def _poses(arm: Arm, true: Arm) -> Array:
    """Return the middle pose and two others as joint positions, (3, nv).

    The middle is the first of `_middles` from which the true arm can do the moves in full size. If
    there is none, it is the first, and the moves are made smaller.
    """
    middles = _middles(arm, true)
    for middle in middles:
        poses = _around(arm, middle, 1.0)
        if _fits(arm, true, poses):
            return poses
    shrinking = 1.0
    while not _fits(arm, true, poses := _around(arm, middles[0], shrinking)):
        shrinking *= 0.7
        if shrinking < SMALLEST_SHRINKING:
            break
    return poses


def _middles(arm: Arm, true: Arm) -> list[Array]:
    """Return the centre of `Sinusoid.inside_limits` and poses that are easy to hold, by distance.

    Those are of a fixed set of random configurations at least 0.5 rad inside the position limits,
    where there is room; the true arm's gravity takes at most half of each effort limit.
    """
    first = arm.to_joint_positions(Sinusoid.inside_limits(arm).center)
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    finite = np.isfinite(lower) & np.isfinite(upper)
    margin = np.minimum(MOVE_SIZE / 0.9, np.where(finite, 0.5 * (upper - lower), np.inf))
    rng = np.random.default_rng(0)
    found = []
    for _ in range(CANDIDATES):
        drawn = arm.to_joint_positions(arm.random_configuration(rng))
        x = np.clip(drawn, lower + margin, upper - margin)
        load = np.abs(true.gravity(arm.from_joint_positions(x))) / true.effort_limit
        if load.max() <= EASY:
            found.append(x)
    found.sort(key=lambda x: float(np.linalg.norm(x - first)))
    return [first, *found[:TRIED]]


def _around(arm: Arm, middle: Array, share: float) -> Array:
    """Return a pose and two others around it, as joint positions (3, nv)."""
    room = np.minimum(middle - arm.lower_position_limit, arm.upper_position_limit - middle)
    size = share * np.minimum(MOVE_SIZE, 0.9 * np.maximum(room, 0.0))
    joint = np.arange(arm.nv)
    first, second = np.where(joint % 2 == 0, 1.0, -1.0), np.where(joint % 4 < 2, -0.7, 0.7)
    return np.array([middle, middle + first * size, middle + second * size])


def _fits(arm: Arm, true: Arm, poses: Array) -> bool:
    order = [arm.from_joint_positions(poses[k]) for k in (0, 1, 2, 0)]
    return not broken_limits(true, _path(arm, order), samples=200, effort_share=EFFORT_SHARE)


def _path(arm: Arm, poses: list[Array]) -> Quintic:
    speed = np.minimum(MOVE_SPEED, SPEED_SHARE * arm.velocity_limit)
    return Quintic.through(
        arm, np.array(poses), velocity_limit=speed, acceleration_limit=MOVE_ACCELERATION
    )


def lasting(course: Course, duration: float) -> Course:
    """Return a course that ends at another time, with the spans that are left of it.

    Where the last half is judged it is the new last half.
    """
    checks.finite_number("duration", duration, above=0.0)
    if duration == course.duration:
        return course
    half = 0.5 * duration
    if course.judged == (0.5 * course.duration, course.duration):
        judged = (half, duration)
    else:
        judged = (min(course.judged[0], half), min(course.judged[1], duration))
    return Course(
        reference=course.reference,
        duration=duration,
        judged=judged,
        rests=tuple(
            rest._replace(end=min(rest.end, duration))
            for rest in course.rests
            if rest.start < duration
        ),
        text=f"{course.text}; cut after {duration:g} s",
    )
