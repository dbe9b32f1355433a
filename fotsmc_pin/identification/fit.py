"""The fit that is linear: weights, time between torque and motion, and what is known afterwards.

In units of the belief, `θ = mean + L z` with `L Lᵀ` its covariance, the most likely `z` minimises
`|z|² + Σ_j |τ_j - X_j θ|² / σ_j²`, where the noise `σ_j` of a joint's rows is that of its residual.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize_scalar

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.identification.prior import Belief
    from fotsmc_pin.identification.regressor import Equations
    from fotsmc_pin.types import Array

ROUNDS = 4
"""Times that the weights are taken from the residual."""
FIRST_NOISE = 0.02
"""Noise of a joint's averaged torque over its swing, before anything is fitted."""
LEAST_NOISE = 1e-7
"""Of the same, at the least: a simulated log may have none."""
LAGS = 12
"""Averages over which the residual is taken to be correlated."""
FARTHEST, STEP = 0.08, 0.004
"""Largest shift in time that is looked for, and step of the search [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """The linear fit.

    Attributes:
        theta: most likely parameters (p,), whether or not a body can have them.
        factor: `L` of the belief (p, p).
        precision: inverse covariance of `z` if noise were white (p, p).
        covariance: of `theta`, with the correlation of the residual in time (p, p).
        noise: standard deviation of each joint's averaged torque (nv,).
        shifts: by which the torque of each piece is later than its motion [s].
    """

    theta: Array
    factor: Array
    precision: Array
    covariance: Array
    noise: Array
    shifts: tuple[float, ...]


def fit(systems: Sequence[Equations], belief: Belief) -> Fit:
    """Return the parameters that explain the torque, with each joint weighted by its own noise."""
    problem = _Problem(systems, belief)
    shifts = [0.0] * len(systems)
    swing = problem.swing()
    least = LEAST_NOISE * np.maximum(swing, swing.max())
    noise = FIRST_NOISE * np.maximum(swing, 1e-3 * swing.max())
    for turn in range(ROUNDS):
        theta, inverse = problem.solve(shifts, noise)
        shifts = [
            later(system, shift, system.table @ theta, noise, search=turn == 0)
            for system, shift in zip(systems, shifts, strict=True)
        ]
        theta, inverse = problem.solve(shifts, noise)
        noise = np.maximum(problem.noise(shifts, theta, inverse, noise), least)
    theta, inverse = problem.solve(shifts, noise)
    return Fit(
        theta=theta,
        factor=problem.factor,
        precision=np.asarray(np.linalg.inv(inverse), dtype=np.float64),
        covariance=problem.covariance(shifts, theta, noise),
        noise=noise,
        shifts=tuple(shifts),
    )


def residuals(system: Equations, shift: float, theta: Array) -> Array:
    """Return measured minus predicted averaged torque (nv, N), zero where a row is not used."""
    return np.where(system.used, system.torque(shift) - system.table @ theta, 0.0)


def later(
    system: Equations, now: float, predicted: Array, noise: Array, *, search: bool = False
) -> float:
    """Return the time by which the torque of a piece is later than its motion [s].

    Args:
        system: the piece; its table is not used.
        now: what the time is held for.
        predicted: averaged torque of the model (nv, N).
        noise: of each joint's averaged torque (nv,).
        search: look far and wide first.
    """

    def misfit(shift: float) -> float:
        difference = np.where(system.used, system.torque(shift) - predicted, 0.0)
        return float(np.sum((difference / noise[:, None]) ** 2))

    around = now
    if search:
        around = float(min(np.arange(-FARTHEST, FARTHEST + 0.5 * STEP, STEP), key=misfit))
    found = minimize_scalar(
        misfit, bounds=(around - STEP, around + STEP), method="bounded", options={"xatol": 1e-6}
    )
    return float(found.x)


class _Problem:
    """The rows of all pieces, in units of the belief."""

    def __init__(self, systems: Sequence[Equations], belief: Belief) -> None:
        self.systems, self.mean = systems, belief.mean
        self.factor: Array = np.asarray(np.linalg.cholesky(belief.covariance), dtype=np.float64)
        # Rows that are not used are zero, in the table and in the torque.
        self.rows = [system.table @ self.factor * system.used[:, :, None] for system in systems]
        self.normal = sum(
            np.einsum("jkp,jkq->jpq", rows, rows, optimize=True) for rows in self.rows
        )
        self.count = sum(np.count_nonzero(system.used, axis=1) for system in systems)

    def swing(self) -> Array:
        """Return the standard deviation of each joint's torque (nv,)."""
        return np.asarray(np.std(np.hstack([s.torque() for s in self.systems]), axis=1))

    def solve(self, shifts: Sequence[float], noise: Array) -> tuple[Array, Array]:
        """Return the most likely parameters (p,), and the covariance of `z` (p, p)."""
        weight = 1.0 / noise**2
        information = np.eye(self.mean.size) + np.tensordot(weight, self.normal, 1)
        right = np.zeros(self.mean.size)
        for system, rows, shift in zip(self.systems, self.rows, shifts, strict=True):
            right += np.einsum("jkp,jk,j->p", rows, residuals(system, shift, self.mean), weight)
        factored = cho_factor(information)
        z = cho_solve(factored, right)
        return self.mean + self.factor @ z, cho_solve(factored, np.eye(z.size))

    def noise(self, shifts: Sequence[float], theta: Array, inverse: Array, noise: Array) -> Array:
        """Return the standard deviation of each joint's residual (nv,), parameters counted off."""
        squares = sum(
            np.sum(residuals(system, shift, theta) ** 2, axis=1)
            for system, shift in zip(self.systems, shifts, strict=True)
        )
        fitted = np.einsum("jpq,qp->j", self.normal, inverse) / noise**2
        return np.asarray(np.sqrt(squares / np.maximum(self.count - fitted, 0.1 * self.count + 1)))

    def covariance(self, shifts: Sequence[float], theta: Array, noise: Array) -> Array:
        """Return the covariance (p, p), each joint's residual correlated as it is seen to be."""
        weighted = [
            without_shift(system, rows / noise[:, None, None], theta, noise)
            for system, rows in zip(self.systems, self.rows, strict=True)
        ]
        information = np.eye(self.mean.size)
        for rows in weighted:
            flat = rows.reshape(-1, self.mean.size)
            information += flat.T @ flat
        inverse = np.linalg.inv(information)
        spread = np.eye(self.mean.size)
        for j in range(noise.size):
            scaled = [
                residuals(system, shift, theta)[j] / noise[j]
                for system, shift in zip(self.systems, shifts, strict=True)
            ]
            correlation = correlations(scaled, self.count[j])
            for rows in weighted:
                own = rows[j]
                filtered = correlation[0] * own
                for lag in range(1, min(len(correlation), len(own))):
                    filtered[lag:] += correlation[lag] * own[:-lag]
                    filtered[:-lag] += correlation[lag] * own[lag:]
                spread += own.T @ filtered
        joint = inverse @ spread @ inverse
        return np.asarray(self.factor @ joint @ self.factor.T)


def without_shift(system: Equations, rows: Array, theta: Array, noise: Array) -> Array:
    """Return weighted rows (nv, N, p) without what a shift of the torque in time explains as well.

    The shift is found with the parameters, which are known the less for it.
    """
    slope = np.gradient(system.table @ theta, system.times, axis=1) * system.used
    slope = slope / noise[:, None]
    size = float(np.sum(slope**2))
    if size == 0.0:
        return rows
    share = np.einsum("jk,jkp->p", slope, rows) / size
    return np.asarray(rows - slope[:, :, None] * share)


def correlations(scaled: Sequence[Array], count: int) -> Array:
    """Return the correlation of a residual with itself by lag, tapered (LAGS + 1,)."""
    found = np.zeros(LAGS + 1)
    for row in scaled:
        for lag in range(min(LAGS + 1, len(row))):
            found[lag] += row[lag:] @ row[: len(row) - lag]
    found /= max(count, 1)
    found[0] = max(found[0], 1.0)
    # A triangle keeps the matrix of these correlations positive.
    return np.asarray(found * (1.0 - np.arange(LAGS + 1) / (LAGS + 1.0)))
