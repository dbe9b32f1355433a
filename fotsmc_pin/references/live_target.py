"""`LiveTarget`: a reference that follows targets as they come."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.compiled import specialized
from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.references.jerk_pieces import PIECES, evaluate, hold_at, write_plan
from fotsmc_pin.references.nearest_pose import NearestPose

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

UNGIVEN_SPEED = 1.0
"""Stands for a speed limit that the arm does not give [rad/s, m/s]."""
TO_FULL_SPEED, TO_FULL_ACCELERATION = 0.25, 0.1
"""Times to full speed and to full acceleration by the limits that are not given [s]."""


class LiveTarget:
    """A reference `t -> (q_d, v_d, a_d)` whose target may be set at any time, from any thread.

    From wherever the reference is, at the speed and acceleration that it has, it goes to the target
    in the shortest time that limits of velocity, acceleration and jerk allow, all joints arriving
    together where they can, and rests there (Ruckig: Berscheid and Kröger 2021). It is planned anew
    at the first tick after a target was set. A target older than `timeout` is stale: the reference
    comes to rest as fast as the limits allow, and holds, until the next one comes.

    Targets outside the position limits are drawn in to `margin` before them. A target that is not
    finite is refused where it is set, and the one before stays in force.

    It works in `simulate` and `run_realtime`. Time is that of the ticks; a tick before the last one
    begins a new run at the start, with no target.

    Attributes:
        arm: the arm that it is for.
        velocity: largest speed of each joint (nv,) [rad/s, m/s].
        acceleration: largest acceleration of each joint (nv,) [rad/s², m/s²].
        jerk: largest jerk of each joint (nv,) [rad/s³, m/s³].
        timeout: age at which a target is stale [s]; inf for never.
        is_live: True; tells `simulate` not to evaluate it ahead of time.
    """

    is_live = True

    def __init__(
        self,
        arm: Arm,
        *,
        q0: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        jerk: ArrayLike | None = None,
        timeout: float = 0.5,
        margin: float = 0.05,
    ) -> None:
        """Begin at rest.

        Args:
            arm: the arm.
            q0: where the reference begins (nq,); `arm.neutral` if None.
            velocity: largest speed, scalar or (nv,) [rad/s, m/s]; by default half the arm's limit,
                and 1 where it gives none.
            acceleration: largest acceleration, scalar or (nv,) [rad/s², m/s²]; by default what
                leads to `velocity` in 0.25 s.
            jerk: largest jerk, scalar or (nv,) [rad/s³, m/s³]; by default what leads to
                `acceleration` in 0.1 s.
            timeout: age at which a target is stale [s].
            margin: how far before the position limits targets are kept [rad, m].

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
            MissingDependencyError: Ruckig is not installed.
        """
        demand_arm(arm)
        self._ruckig = ruckig = _ruckig()
        self.arm, n, self._neutral = arm, arm.nv, pin.neutral(arm.model)
        own = np.where(np.isfinite(arm.velocity_limit), 0.5 * arm.velocity_limit, UNGIVEN_SPEED)
        self.velocity = _limit("velocity", velocity, own)
        self.acceleration = _limit("acceleration", acceleration, self.velocity / TO_FULL_SPEED)
        self.jerk = _limit("jerk", jerk, self.acceleration / TO_FULL_ACCELERATION)
        endless = timeout == np.inf
        self.timeout = timeout if endless else checks.finite_number("timeout", timeout, above=0.0)
        self._start = self._position(arm.neutral if q0 is None else q0, np.zeros(n))
        margin = checks.finite_number("margin", margin, at_least=0.0)
        self._lower = np.minimum(arm.lower_position_limit + margin, self._start)
        self._upper = np.maximum(arm.upper_position_limit - margin, self._start)
        self._kinematics = NearestPose(arm, self._lower, self._upper)
        self._planner, self._plan = ruckig.Ruckig(n), ruckig.Trajectory(n)
        self._wish = ruckig.InputParameter(n)
        self._wish.max_velocity = self.velocity.tolist()
        self._wish.max_acceleration = self.acceleration.tolist()
        self._wish.max_jerk = self.jerk.tolist()
        self._lock = threading.Lock()
        self._table = np.zeros((5, PIECES, n))
        self._evaluate = specialized(evaluate, 0.0, self._table, np.zeros((3, n)))
        self.reset()

    def reset(self) -> None:
        """Go back to the start, at rest, with no target."""
        with self._lock:
            self._given: tuple[int, Array] = (0, self._start)
        self._taken, self._taken_at, self._is_stale = 0, -np.inf, True
        self._t, self._began = -np.inf, 0.0
        hold_at(self._start, self._table)

    @property
    def is_stale(self) -> bool:
        """Whether the reference holds, or comes to rest, for want of a fresh target."""
        return self._is_stale

    def set_q(self, q: ArrayLike) -> None:
        """Set the target (nq,); continuous joints turn the short way from the last one.

        Raises:
            ArgumentError: a wrong shape, or entries that are not finite.
        """
        with self._lock:
            number, last = self._given
            x = np.clip(self._position(q, last), self._lower, self._upper)
            self._given = (number + 1, x)

    def set_pose(self, pose: pin.SE3 | ArrayLike) -> float:
        """Set the target as a pose of the tool; out of reach, what comes nearest is taken.

        Inverse kinematics start from the last target, and stay within the position limits.

        Args:
            pose: of the arm's tool frame in the world, a `pin.SE3` or homogeneous (4, 4); or a
                position alone (3,) [m], at any orientation.

        Returns:
            How far the tool stays from the position of the pose [m].

        Raises:
            ArgumentError: a wrong shape, entries that are not finite, or no rotation.
        """
        with self._lock:
            number, last = self._given
            x, distance = self._kinematics.solve(pose, last)
            self._given = (number + 1, x)
        return distance

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s], all fresh arrays."""
        if t < self._t:
            self.reset()
        self._t = t
        number, x = self._given
        if number != self._taken:
            self._taken, self._taken_at, self._is_stale = number, t, False
            self._go(t, x)
        elif not self._is_stale and t - self._taken_at > self.timeout:
            self._is_stale = True
            self._go(t, None)
        motion = np.empty((3, self._start.size))
        self._evaluate(t - self._began, self._table, motion)
        position, v_d, a_d = motion
        if self.arm.is_euclidean:
            return position, v_d, a_d
        return pin.integrate(self.arm.model, self._neutral, position), v_d, a_d

    def _go(self, t: float, x: Array | None) -> None:
        """Plan the way from the present motion to `x` (nv,), or to rest where that is None."""
        motion = np.empty((3, self._start.size))
        self._evaluate(t - self._began, self._table, motion)
        wish, kinds = self._wish, self._ruckig.ControlInterface
        wish.current_position, wish.current_velocity, wish.current_acceleration = motion.tolist()
        wish.control_interface = kinds.Velocity if x is None else kinds.Position
        if x is not None:
            wish.target_position = x.tolist()
        # Ruckig cannot always make all joints arrive together (an error in its "step 2").
        for together in (self._ruckig.Synchronization.Time, self._ruckig.Synchronization.No):
            wish.synchronization = together
            try:
                found = self._planner.calculate(wish, self._plan)
            except self._ruckig.RuckigError:
                continue
            if found in (self._ruckig.Result.Working, self._ruckig.Result.Finished):
                write_plan(self._plan.profiles[0], motion, self._table)
                self._began = t
                return
        # The plan before stays in force: it keeps the limits, and ends at rest.

    def _position(self, q: ArrayLike, near: Array) -> Array:
        """Return joint positions (nv,) of `q`, a full turn or more of it nearest to `near`."""
        arm = self.arm
        q = checks.finite_vector("q", q, arm.nq)
        if arm.is_euclidean:
            return q
        if not pin.isNormalized(arm.model, q, 1e-3):
            raise ArgumentError("q", q, "give the cosine and sine of each continuous joint")
        here = pin.integrate(arm.model, self._neutral, near)
        x: Array = near + pin.difference(arm.model, here, q)
        return x


def _limit(name: str, given: ArrayLike | None, own: Array) -> Array:
    return own.copy() if given is None else checks.per_joint(name, given, own.size, above=0.0)


def _ruckig() -> Any:
    try:
        import ruckig
    except ImportError:
        raise MissingDependencyError("LiveTarget needs Ruckig: pip install ruckig") from None
    return ruckig
