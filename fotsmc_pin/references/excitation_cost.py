"""`Cost`: how badly a motion shows the parameters, and how far it breaks bounds, with gradient."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.arms.self_collision import SelfCollision
    from fotsmc_pin.references.excitation_room import Room
    from fotsmc_pin.references.fourier import RestingSeries
    from fotsmc_pin.references.visibility import Regressor
    from fotsmc_pin.types import Array

SAMPLES = 80
"""Times of a period at which the regressor is taken."""
BOUND_SAMPLES = 200
"""Times at which position, speed and acceleration are compared with their bounds."""
EACH = 2
"""One of so many samples is looked at for collisions."""
PRIOR = 1e-3
"""What is known beforehand: each parameter to within its scale, worth this much of a reading."""
NUDGE = 1e-6
"""Step of the differences that make the gradient of the regressor [rad, rad/s, rad/s²]."""
INSIDE = 0.97
"""Share of the bounds at which the penalty begins, so that what is found keeps them."""
APPROACH = 0.03
"""Distance beyond the clearance at which the penalty for coming close begins [m]."""


class Cost:
    """`log tr (BᵀYᵀYB + λI)⁻¹` and penalties, as a function of a motion's coefficients.

    The trace is the sum of the variances with which the sums of parameters that torque depends on
    would be estimated, in scaled parameters (A-optimality, with a prior `λ` that spends no motion
    on what cannot be seen). It is ruled by the smallest singular values of the regressor, so that
    it conditions the regressor well; unlike the condition number it is smooth, and wants large and
    fast motions. Adding the logarithm of the largest singular value, to make it the condition
    number, let weak arms stand still.

    A motion is `coefficients` (nv, 1 + free): the middle of each joint's series, in units of half
    its range, then its free coefficients, in units of the largest amplitude that it can have.
    """

    def __init__(
        self,
        arm: Arm,
        series: RestingSeries,
        room: Room,
        regressor: Regressor,
        collision: SelfCollision,
    ) -> None:
        self.arm, self.series, self.room = arm, series, room
        self.regressor, self.collision = regressor, collision
        self.penalty = 1.0
        self.middle, self.half = 0.5 * (room.upper + room.lower), 0.5 * (room.upper - room.lower)
        slowest = series.omega[0]
        reach = np.minimum(room.velocity / slowest, room.acceleration / slowest**2)
        self.amplitude = np.minimum(self.half, reach)
        period = series.period
        self._bases = self._free_basis(period * (np.arange(SAMPLES) + 0.5) / SAMPLES)
        self._fine = self._free_basis(period * np.arange(BOUND_SAMPLES) / BOUND_SAMPLES)

    @property
    def shape(self) -> tuple[int, int]:
        """Shape of the coefficients."""
        return self.arm.nv, 1 + self.series.free.shape[1]

    def _free_basis(self, t: Array) -> list[Array]:
        return [part @ self.series.free for part in self.series.basis(t)]

    def check_bases(self, step: float) -> list[Array]:
        """Return bases for `motion` at times that are at most `step` [s] apart, a whole period."""
        count = int(np.ceil(self.series.period / step))
        return self._free_basis(self.series.period * np.arange(count) / count)

    def motion(self, coefficients: Array, bases: list[Array]) -> tuple[Array, Array, Array]:
        """Return joint positions, speeds and accelerations, (N, nv) each."""
        free = coefficients[:, 1:] * self.amplitude[:, None]
        x, v, a = (basis @ free.T for basis in bases)
        return x + self.middle + self.half * coefficients[:, 0], v, a

    def configurations(self, x: Array) -> Array:
        """Return the configurations (N, nq) of joint positions (N, nv)."""
        if self.arm.is_euclidean:
            return x
        start = pin.neutral(self.arm.model)
        return np.array([pin.integrate(self.arm.model, start, row) for row in x])

    def information(self, coefficients: Array) -> Array:
        """Return `BᵀYᵀYB` of one period, a mean over its samples, (rank, rank)."""
        x, v, a = self.motion(coefficients, self._bases)
        seen = self.regressor.table(self.configurations(x), v, a).reshape(-1, self.regressor.size)
        seen = seen @ self.regressor.base
        return seen.T @ seen / len(x)

    def __call__(self, flat: Array) -> tuple[float, Array]:
        """Return the cost of coefficients (flattened) and its gradient."""
        coefficients = flat.reshape(self.shape)
        x, v, a = self.motion(coefficients, self._bases)
        q = self.configurations(x)
        value, slopes = self._visibility(q, v, a)
        of_x, of_v, of_a = slopes
        close, of_distance = self._closeness(q[::EACH])
        of_x[::EACH] += of_distance
        gradient = self._collect(of_x, of_v, of_a, self._bases)
        beyond, of_bounds = self._bounds(coefficients)
        return value + close + beyond, (gradient + of_bounds).ravel()

    def _collect(self, of_x: Array, of_v: Array, of_a: Array, bases: list[Array]) -> Array:
        slopes = [slope.T @ basis for slope, basis in zip((of_x, of_v, of_a), bases, strict=True)]
        free = sum(slopes[1:], slopes[0]) * self.amplitude[:, None]
        return np.column_stack([of_x.sum(axis=0) * self.half, free])

    def _visibility(self, q: Array, v: Array, a: Array) -> tuple[float, list[Array]]:
        """Return the criterion with the penalty on efforts, and slopes (N, nv) of q, v and a."""
        regressor, base = self.regressor, self.regressor.base
        table = regressor.table(q, v, a)
        seen = table.reshape(-1, regressor.size) @ base
        information = seen.T @ seen / len(q)
        inverse = np.linalg.inv(information + PRIOR * np.eye(len(information)))
        trace = float(np.trace(inverse))
        pull = (seen @ (inverse @ inverse)) @ base.T * (-2.0 / (trace * len(q)))
        pull = pull.reshape(table.shape)
        # Efforts in units of the limits, from the same table.
        unit = 1.0 / (regressor.rows * self.room.effort_limit)
        share = table @ regressor.nominal * unit
        excess, side = self._excess(share, self.room.effort / self.room.effort_limit)
        weight = self.penalty / len(q)
        pull += (2.0 * weight * side * unit)[:, :, None] * regressor.nominal
        value = np.log(trace) + weight * float((excess**2).sum())
        return value, self._slopes(q, v, a, pull)

    def _slopes(self, q: Array, v: Array, a: Array, pull: Array) -> list[Array]:
        """Return how `Σ pull · table` changes with q, v and a, (N, nv) each."""
        n, regressor, model = self.arm.nv, self.regressor, self.arm.model
        pull = pull * regressor.rows[:, None]
        of_links = pull[:, :, : 10 * n] * regressor.columns
        flat = np.ascontiguousarray(of_links.transpose(0, 2, 1)).reshape(len(q), -1)
        slopes = [np.zeros_like(v) for _ in range(3)]
        steps = NUDGE * np.eye(n)
        plain = self.arm.is_euclidean
        for k, weights in enumerate(flat):
            here = (q[k], v[k], a[k])
            now = weights @ regressor.links(*here).reshape(-1)
            for j, step in enumerate(steps):
                turned = here[0] + step if plain else pin.integrate(model, here[0], step)
                moved = (
                    (turned, here[1], here[2]),
                    (here[0], here[1] + step, here[2]),
                    (here[0], here[1], here[2] + step),
                )
                for slope, state in zip(slopes, moved, strict=True):
                    slope[k, j] = weights @ regressor.links(*state).reshape(-1) - now
        slopes = [slope / NUDGE for slope in slopes]
        joint = np.arange(n)
        own = [pull[:, joint, (10 + kind) * n + joint] for kind in range(3)]
        rotor, viscous, coulomb = (p * s for p, s in zip(own, regressor.of_joints, strict=True))
        slopes[2] += rotor
        slopes[1] += (
            viscous + coulomb * (1.0 - np.tanh(v / regressor.smooth) ** 2) / regressor.smooth
        )
        return slopes

    @staticmethod
    def _excess(values: Array, bounds: Array) -> tuple[Array, Array]:
        """Return how far values are beyond `±bounds`, and the same with the value's sign."""
        excess = np.maximum(np.abs(values) - INSIDE * bounds, 0.0)
        return excess, excess * np.sign(values)

    def _bounds(self, coefficients: Array) -> tuple[float, Array]:
        x, v, a = self.motion(coefficients, self._fine)
        weight = self.penalty / len(x)
        value, slopes = 0.0, []
        units = self.half, self.room.velocity, self.room.acceleration
        for motion, unit in zip((x - self.middle, v, a), units, strict=True):
            excess, side = self._excess(motion / unit, np.ones_like(unit))
            value += weight * float((excess**2).sum())
            slopes.append(2.0 * weight * side / unit)
        return value, self._collect(slopes[0], slopes[1], slopes[2], self._fine)

    def _closeness(self, q: Array) -> tuple[float, Array]:
        slopes = np.zeros((len(q), self.arm.nv))
        collision = self.collision
        if not collision.pairs:
            return 0.0, slopes
        # Pairs that are near by design are pushed away only where they overlap.
        reach = collision.clearances + np.where(collision.clearances > 0.0, APPROACH, 0.0)
        value = 0.0
        weight = 0.1 * self.penalty / len(q)
        for k, row in enumerate(q):
            distances = collision.prepare_gradients(row)
            for pair in np.flatnonzero(distances < reach):
                depth = (reach[pair] - distances[pair]) / APPROACH
                value += weight * depth**2
                slopes[k] -= 2.0 * weight * depth / APPROACH * collision.gradient(int(pair))
        return value, slopes
