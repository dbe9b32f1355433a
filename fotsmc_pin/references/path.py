"""`JointPath`: piecewise polynomials in every joint, the base of planned references."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import PPoly

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.compiled import kernel, specialized
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class JointPath:
    """A reference made of polynomials between break points.

    Position, velocity and acceleration are one polynomial and its derivatives, so they agree to
    rounding. Before its start the path rests where it begins, after its end where it ends.

    Attributes:
        arm: the arm that it is for.
        breaks: times at which the pieces meet, (pieces + 1,) [s], from 0.
        coefficients: of each piece, in the time since it began, highest power first,
            (order, pieces, nv).
    """

    arm: Arm
    breaks: Array
    coefficients: Array

    @property
    def duration(self) -> float:
        """When the path ends [s]."""
        return float(self.breaks[-1])

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s], all fresh arrays."""
        breaks, coefficients, plain = self._pieces
        motion = np.empty((3, coefficients.shape[2]))
        piece_code()(t, breaks, coefficients, motion)
        if plain:
            return motion[0], motion[1], motion[2]
        return self.arm.from_joint_positions(motion[0]), motion[1], motion[2]

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return `q_d` (N, nq), `v_d` and `a_d` (N, nv) at the times `t` (N,) [s]."""
        breaks, coefficients, plain = self._pieces
        motion = np.empty((len(t), 3, coefficients.shape[2]))
        along_many(np.asarray(t, dtype=np.float64), breaks, coefficients, motion)
        x, v_d, a_d = (np.ascontiguousarray(motion[:, order]) for order in range(3))
        if plain:
            return x, v_d, a_d
        return np.array([self.arm.from_joint_positions(row) for row in x]), v_d, a_d

    @cached_property
    def _pieces(self) -> tuple[Array, Array, bool]:
        """Break points and coefficients as the kernels want them; whether `q` is a plain vector."""
        return (
            np.array(self.breaks, dtype=np.float64),
            np.array(self.coefficients, dtype=np.float64, order="C"),
            self.arm.is_euclidean,
        )

    def extremes(self, order: int) -> tuple[Array, Array]:
        """Return the least and greatest value of each joint's position or a derivative of it.

        Args:
            order: 0 for position, 1 for velocity, 2 for acceleration.

        Returns:
            values: (2, nv), least and greatest.
            times: (2, nv) [s], when they occur.
        """
        values, times = np.empty((2, self.arm.nv)), np.empty((2, self.arm.nv))
        for joint in range(self.arm.nv):
            curve = PPoly(self.coefficients[:, :, joint], self.breaks).derivative(order)
            turns = curve.derivative().roots(discontinuity=False, extrapolate=False)
            moments = np.concatenate([self.breaks, turns[np.isfinite(turns)]])
            heights = curve(moments)
            for row, place in enumerate((np.argmin(heights), np.argmax(heights))):
                values[row, joint], times[row, joint] = heights[place], moments[place]
        return values, times

    def demand_limits(
        self, argument: str, value: object, velocity_limit: Array, acceleration_limit: Array
    ) -> None:
        """Require that the path keeps within position, velocity and acceleration limits.

        Raises:
            ArgumentError: naming `argument`, the joint, the time and the limit that is exceeded.
        """
        arm = self.arm
        bounds = (
            ("a position", (arm.lower_position_limit, arm.upper_position_limit), ""),
            ("a velocity", (-velocity_limit, velocity_limit), "/s"),
            ("an acceleration", (-acceleration_limit, acceleration_limit), "/s²"),
        )
        for order, (what, (lowest, highest), per) in enumerate(bounds):
            values, times = self.extremes(order)
            slack = 1e-9 * (1.0 + np.abs(values))
            below, above = values[0] < lowest - slack[0], values[1] > highest + slack[1]
            for row, broken, limits in ((0, below, lowest), (1, above, highest)):
                if not broken.any():
                    continue
                joint = int(np.argmax(broken))
                unit = arm.position_units[joint] + per
                raise ArgumentError(
                    argument,
                    value,
                    f"{arm.joint_names[joint]} would reach {what} of {values[row, joint]:.4g} "
                    f"{unit} at {times[row, joint]:.3g} s, beyond its limit of "
                    f"{limits[joint]:.4g} {unit}",
                )


def unwrapped(arm: Arm, argument: str, configurations: ArrayLike) -> Array:
    """Return configurations, (n, nq), as joint positions, (n, nv), without jumps of a full turn.

    Raises:
        ArgumentError: a wrong shape or entries that are not finite.
    """
    demand_arm(arm)
    try:
        rows = np.array(configurations, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArgumentError(argument, configurations, f"give rows of {arm.nq} numbers") from None
    if rows.ndim != 2 or rows.shape[1] != arm.nq or not len(rows) or not np.isfinite(rows).all():
        raise ArgumentError(
            argument, configurations, f"give rows of {arm.nq} finite numbers, (n, {arm.nq})"
        )
    steps = [arm.difference(one, two) for one, two in pairwise(rows)]
    return np.cumsum([arm.to_joint_positions(rows[0]), *steps], axis=0)


@cache
def piece_code() -> Any:
    """Return the machine code of `along`, which skips the look-up of types at each call."""
    return specialized(along, 0.0, np.zeros(2), np.zeros((1, 1, 1)), np.zeros((3, 1)))


@kernel
def along(t: float, breaks: Array, coefficients: Array, motion: Array) -> None:
    """Write position, velocity and acceleration at time `t` into `motion` (3, nv)."""
    last = breaks.size - 2
    inside = breaks[0] <= t <= breaks[last + 1]
    t = min(max(t, breaks[0]), breaks[last + 1])
    low, high = 0, last
    while low < high:
        middle = (low + high + 1) // 2
        if t >= breaks[middle]:
            low = middle
        else:
            high = middle - 1
    s = t - breaks[low]
    for j in range(motion.shape[1]):
        x = v = half_a = 0.0
        for power in range(coefficients.shape[0]):
            half_a = half_a * s + v
            v = v * s + x
            x = x * s + coefficients[power, low, j]
        motion[0, j] = x
        motion[1, j] = v if inside else 0.0
        motion[2, j] = 2.0 * half_a if inside else 0.0


@kernel
def along_many(t: Array, breaks: Array, coefficients: Array, motion: Array) -> None:
    """Write what `along` does at the times `t` (N,) into `motion` (N, 3, nv)."""
    for k in range(t.size):
        along(t[k], breaks, coefficients, motion[k])
