"""`Excitation`: a periodic motion that shows the dynamic parameters of an arm."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.arms.columns import heads
from fotsmc_pin.arms.self_collision import SelfCollision
from fotsmc_pin.files import replacing
from fotsmc_pin.progress import reporting
from fotsmc_pin.references.excitation_cost import Cost
from fotsmc_pin.references.excitation_design import designed
from fotsmc_pin.references.excitation_room import Room, demand_room
from fotsmc_pin.references.fourier import RestingSeries
from fotsmc_pin.references.visibility import Regressor, Scales, Seen, seen_in

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.progress import Progress
    from fotsmc_pin.types import Array

READING_RATE = 10.0
"""Readings of torque that tell something new in a second: faster ones share their errors [1/s]."""


@dataclass(frozen=True, eq=False)
class Excitation:
    """A periodic motion from which the parameters of an arm can be told: for identification.

    Every joint follows a finite Fourier series (Swevers et al., IEEE Trans. Robotics and Automation
    13(5), 1997), `x(t) = c + Σ a_k sin(kωt) + b_k cos(kωt)` with `ω = 2π / period`, that begins and
    ends each period at rest: velocity and acceleration are zero. The series are searched for such
    that the regressor of the base parameters, with rotors and viscous and Coulomb friction, is
    well conditioned and the estimates' variance is small, see `excitation_cost.Cost`.

    The motion keeps, at times 5 ms apart and by the model of `arm` (friction included where the
    arm has some): positions within the range less `position_margin` of it at each end, and within
    π (0.5 m) of `arm.neutral`; speeds and accelerations within `velocity_share` of their limits;
    efforts within `effort_share`, the rest being for what the model does not know; and links at
    least `clearance` apart from each other (`SelfCollision` in `arms/self_collision.py`), and from
    a `floor`. What else stands around the arm is not known to it: narrow the arm's position limits.

    Where the arm gives no velocity limit, 2 rad/s or 0.5 m/s count; where it gives no effort limit,
    twice the largest weight.

    The same seed and arguments give the same motion on one machine. Designing it takes seconds
    (two joints) to half a minute (seven joints).

    Attributes:
        arm: the arm that it is for.
        seed: of the random starts of the search.
        period: of the series [s].
        repetitions: how often the period is run; repeated periods show the noise.
        harmonics: number of frequencies of each series, at least 2.
        position_margin: share of each joint's range that is left free at each end.
        velocity_share: share of the velocity and acceleration limits in use, in (0, 1].
        acceleration_limit: scalar or (nv,) [rad/s², m/s²]; by default what reaches the velocity
            limit within 0.2 s.
        effort_share: share of the effort limits in use, in (0, 1].
        clearance: least distance between links [m].
        floor: height in the frame of the world that no link goes below [m]; None for no floor.
        progress: True shows a bar on standard error while it is designed; a callable is told the
            fraction done.

    Raises:
        ArgumentError: an argument is unusable; or no pose is free of collision and can be held.
    """

    arm: Arm
    seed: int = 0
    period: float = field(default=10.0, kw_only=True)
    repetitions: int = field(default=3, kw_only=True)
    harmonics: int = field(default=8, kw_only=True)
    position_margin: float = field(default=0.05, kw_only=True)
    velocity_share: float = field(default=0.8, kw_only=True)
    acceleration_limit: ArrayLike | None = field(default=None, kw_only=True)
    effort_share: float = field(default=0.6, kw_only=True)
    clearance: float = field(default=0.01, kw_only=True)
    floor: float | None = field(default=None, kw_only=True)
    progress: Progress = field(default=False, kw_only=True, repr=False)
    _cost: Cost = field(init=False, repr=False)
    _coefficients: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Check the arguments and design the motion."""
        demand_arm(self.arm)
        seed = checks.count("seed", self.seed, at_least=0)
        period = checks.finite_number("period", self.period, above=0.0)
        checks.count("repetitions", self.repetitions)
        series = RestingSeries(period, checks.count("harmonics", self.harmonics, at_least=2))
        room = Room.of(
            self.arm,
            position_margin=self.position_margin,
            velocity_share=self.velocity_share,
            acceleration_limit=self.acceleration_limit,
            effort_share=self.effort_share,
        )
        demand_room(self.arm, room)
        clearance = checks.finite_number("clearance", self.clearance, at_least=0.0)
        if self.floor is not None:
            checks.finite_number("floor", self.floor)
        regressor = Regressor(self.arm, Scales.of(self.arm, room.velocity, room.full_scale))
        collision = SelfCollision(self.arm, clearance=clearance, floor=self.floor)
        cost = Cost(self.arm, series, room, regressor, collision)
        with reporting(self.progress, f"Designing a motion of {self.arm.name}") as report:
            found = designed(cost, np.random.default_rng(seed), report)
        object.__setattr__(self, "_cost", cost)
        object.__setattr__(self, "_coefficients", found)

    @property
    def duration(self) -> float:
        """Length of the motion, `period · repetitions` [s]; afterwards the arm rests."""
        return self.period * self.repetitions

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s], all fresh arrays."""
        q_d, v_d, a_d = self.at(np.array([t], dtype=np.float64))
        return q_d[0], v_d[0], a_d[0]

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return `q_d` (N, nq), `v_d` and `a_d` (N, nv) at the times `t` (N,) [s]."""
        x, v_d, a_d = self.joint_motion(t)
        return np.array(self._cost.configurations(x)), v_d, a_d

    def joint_motion(self, t: Array) -> tuple[Array, Array, Array]:
        """Return joint positions [rad, m], velocities and accelerations at the times `t`, (N, nv).

        A continuous joint has one position, which does not jump.
        """
        inside = np.clip(np.asarray(t, dtype=np.float64), 0.0, self.duration)
        bases = [basis @ self._cost.series.free for basis in self._cost.series.basis(inside)]
        return self._cost.motion(self._coefficients, bases)

    def to_csv(self, path: str | PathLike[str], *, rate: float = 100.0) -> None:
        """Write the motion: times, then positions, velocities and accelerations of all joints.

        The header is `t [s],q.JOINT [rad],…,v.JOINT [rad/s],…,a.JOINT [rad/s²],…`; a continuous
        joint has one column, its angle. `Spline.from_csv` reads it, as `fotsmc simulate
        --reference` does.

        Args:
            path: the file; it is replaced.
            rate: rows in a second [1/s].

        Raises:
            ArgumentError: a rate at which the fastest sine has fewer than ten rows.
        """
        least = 10.0 * self.harmonics / self.period
        rate = checks.finite_number("rate", rate, at_least=least)
        t = np.arange(round(rate * self.duration) + 1) / rate
        table = np.column_stack([t, *self.joint_motion(t)])
        with replacing(path) as stream:
            lines = [",".join(heads(self.arm, ("q", "v", "a")))]
            lines += [",".join(format(number, ".9g") for number in row) for row in table.tolist()]
            stream.write(("\n".join(lines) + "\n").encode())

    @property
    def room(self) -> Room:
        """Bounds that the motion keeps."""
        return self._cost.room

    @property
    def collision_pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of the shapes that are kept apart from each other."""
        return self._cost.collision.pairs

    @cached_property
    def condition_number(self) -> float:
        """Condition number of the base regressor in scaled parameters, over one period.

        The parameters are scaled by the sizes of `visibility.Scales`, torques by full
        scale, so that the number does not depend on units.
        """
        sizes = np.linalg.eigvalsh(self._cost.information(self._coefficients))
        return float(np.sqrt(sizes[-1] / max(sizes[0], 1e-300)))

    @cached_property
    def seen(self) -> tuple[Seen, ...]:
        """What the motion tells of each parameter, by torques with noise of 0.5 % of full scale.

        Full scale are the effort limits, all made smaller by one factor where no state within the
        bounds needs half of any. Ten readings a second count, as those in between share the errors
        of model and filters.
        """
        readings = READING_RATE * self.duration
        information = readings * self._cost.information(self._coefficients)
        return seen_in(self._cost.regressor, information)
