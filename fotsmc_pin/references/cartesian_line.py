"""`CartesianLine`: the tool along a straight line, from rest to rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.checks import count, finite_number, finite_vector
from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.references.path import JointPath
from fotsmc_pin.references.spline import spline_pieces
from fotsmc_pin.references.time_scaling import motion_limits, stretched_to_limits

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


CLOSE = 1e-8  # Largest error of inverse kinematics [m and rad].
MOST_STEPS = 50


@dataclass(frozen=True, kw_only=True, eq=False)
class CartesianLine(JointPath):
    """A straight path of the tool frame that keeps its orientation, from rest to rest.

    The tool's progress along the line is the quintic `10 u³ - 15 u⁴ + 6 u⁵`, `u = t / duration`.
    Inverse kinematics (pink, the extra "ik") finds joint positions at knots; a quintic spline
    through them is the reference. Its derivatives are exact; between knots the tool leaves the line
    by no more than `deviation`.

    Attributes:
        deviation: largest distance of the tool from its place on the line, measured between the
            knots [m].
    """

    deviation: float

    @classmethod
    def along(
        cls,
        arm: Arm,
        displacement: ArrayLike,
        *,
        q: ArrayLike | None = None,
        duration: float | None = None,
        keep_orientation: bool | None = None,
        velocity_limit: ArrayLike | None = None,
        acceleration_limit: ArrayLike | None = None,
        knots: int = 101,
    ) -> CartesianLine:
        """Plan a line.

        Args:
            arm: the arm; `arm.tool_frame` is moved.
            displacement: from start to end in world axes, (3,) [m].
            q: configuration at the start, (nq,); `arm.neutral` by default.
            duration: [s]; by default as short as the limits allow.
            keep_orientation: whether the tool keeps its orientation; by default where the arm has
                six joints or more.
            velocity_limit: scalar or (nv,) [rad/s or m/s]; by default the arm's.
            acceleration_limit: scalar or (nv,) [rad/s² or m/s²]; by default none.
            knots: number of points at which inverse kinematics is solved.

        Raises:
            MissingDependencyError: pink or its solver is not installed.
            ArgumentError: the tool cannot follow, with the place where it stops; or a limit would
                be exceeded: which, where and when.
        """
        way = finite_vector("displacement", displacement, 3)
        demand_arm(arm)
        start = arm.neutral if q is None else finite_vector("q", q, arm.nq)
        if keep_orientation is None:
            keep_orientation = arm.nv >= 6
        u = np.linspace(0.0, 1.0, count("knots", knots, at_least=6))
        solver = _Kinematics(arm, start, keep_orientation=keep_orientation)
        x = solver.follow(way, _along(u))
        velocity, acceleration = motion_limits(arm, velocity_limit, acceleration_limit)

        def make(breaks: Array) -> CartesianLine:
            breaks, coefficients = spline_pieces(breaks, x)
            return cls(arm=arm, breaks=breaks, coefficients=coefficients, deviation=np.nan)

        if duration is None:
            if np.isinf(velocity).any() and np.isinf(acceleration).any():
                raise ArgumentError("duration", None, "the arm gives no speed limit: give one")
            breaks = stretched_to_limits(make, u, velocity, acceleration)
        else:
            breaks = u * finite_number("duration", duration, above=0.0)
        path = make(breaks)
        path.demand_limits("displacement", displacement, velocity, acceleration)
        middles = 0.5 * (u[1:] + u[:-1])
        deviation = max(
            solver.distance(path(float(v * breaks[-1]))[0], way * float(_along(v))) for v in middles
        )
        return cls(arm=arm, breaks=breaks, coefficients=path.coefficients, deviation=deviation)


def _along(u: Any) -> Any:
    """Fraction of the line at the fraction `u` of the time."""
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


class _Kinematics:
    """Inverse kinematics of the tool frame by pink, from one start."""

    def __init__(self, arm: Arm, q: Array, *, keep_orientation: bool) -> None:
        pink = _pink()
        self._arm, self._solve = arm, pink.solve_ik
        # Pink adds attributes to the model that it is given, and finds frames by name alone.
        self._model = pin.Model(arm.model)
        name = "tool of the line"
        self._model.frames[arm.tool_frame_id].name = name
        self._frame = arm.tool_frame_id
        self._task = pink.tasks.FrameTask(
            name, position_cost=1.0, orientation_cost=1.0 if keep_orientation else 0.0
        )
        self._parts = slice(0, 6 if keep_orientation else 3)
        self._configuration = pink.Configuration(self._model, self._model.createData(), q)
        self._start = self._configuration.get_transform_frame_to_world(name).copy()

    def follow(self, way: Array, shares: Array) -> Array:
        """Return joint positions, (n, nv), at fractions of the line."""
        rows = [self._arm.to_joint_positions(self._configuration.q)]
        for share in shares[1:]:
            before = self._configuration.q
            self._reach(way, float(share))
            rows.append(rows[-1] + self._arm.difference(before, self._configuration.q))
        return np.array(rows)

    def distance(self, q: Array, moved: Array) -> float:
        """Distance of the tool at `q` from its start moved by a vector [m]."""
        data = self._model.createData()
        pin.framesForwardKinematics(self._model, data, q)
        place = data.oMf[self._frame].translation
        return float(np.linalg.norm(place - self._start.translation - moved))

    def _reach(self, way: Array, share: float) -> None:
        target = pin.SE3(self._start.rotation, self._start.translation + share * way)
        self._task.set_target(target)
        for _ in range(MOST_STEPS):
            error = self._task.compute_error(self._configuration)[self._parts]
            if np.abs(error).max() < CLOSE:
                return
            velocity = self._solve(
                self._configuration,
                [self._task],
                1.0,
                solver="daqp",
                damping=1e-10,
                limits=[self._model.configuration_limit],
            )
            self._configuration.integrate_inplace(velocity, 1.0)
        length = float(np.linalg.norm(way))
        raise ArgumentError(
            "displacement",
            way.tolist(),
            f"the tool gets no farther than {share * length:.3g} of {length:.3g} m: out of reach, "
            "at a joint limit, or not free to keep its orientation",
        )


def _pink() -> Any:
    try:
        import daqp  # noqa: F401
        import pink
        import pink.tasks
    except ImportError as error:
        raise MissingDependencyError(
            f"a Cartesian line needs {error.name}: pip install pin-pink daqp"
        ) from None
    return pink
