"""Gauss quadrature of a discrete positive measure: many points become few."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from fotsmc_pin.types import Array


def jacobi_matrix(points: Array, weights: Array, size: int) -> Array:
    """Return the Jacobi matrix of the measure `Σ weights_i δ(points_i)`, (size, size).

    Lanczos iteration on `diag(points)` from `√weights`, orthogonalized twice in full. Its leading
    blocks are the Jacobi matrices of the smaller rules. It comes out smaller than asked for where
    the measure has too few distinct points to working accuracy.
    """
    basis = np.zeros((size + 1, points.size))
    basis[0] = np.sqrt(weights / weights.sum())
    diagonal, beside = np.zeros(size), np.zeros(size)
    reached = size
    for k in range(size):
        image = points * basis[k]
        diagonal[k] = basis[k] @ image
        for _ in range(2):
            image = image - basis[: k + 1].T @ (basis[: k + 1] @ image)
        beside[k] = np.linalg.norm(image)
        if beside[k] <= 1e-15 * points.max():
            reached = k + 1
            break
        basis[k + 1] = image / beside[k]
    side = beside[: reached - 1]
    return np.diag(diagonal[:reached]) + np.diag(side, 1) + np.diag(side, -1)


def gauss_rule(jacobi: Array, mass: float) -> tuple[Array, Array]:
    """Return points and weights of the Gauss rule of a Jacobi matrix [Golub and Welsch 1969].

    Points that rounding brought below zero are set to zero: the measure lives on `[0, ∞)`.
    """
    points, vectors = np.linalg.eigh(jacobi)
    return np.maximum(points, 0.0), mass * vectors[0] ** 2


def merge(
    points: Array,
    weights: Array,
    limits: Iterable[float],
    evaluate: Callable[[Array], Array],
    allowed: Array,
) -> tuple[Array, Array]:
    """Replace the points up to one of the limits by the Gauss rule that saves most points.

    Args:
        points: of the measure, (N,), not negative.
        weights: of the measure, (N,), positive.
        limits: which parts `points <= limit` to try.
        evaluate: values of the functions that the measure integrates, (functions, points).
        allowed: how far each integral may change, (functions,).
    """
    best = points, weights
    for limit in limits:
        low = points <= limit
        if low.sum() < 2:
            continue
        exact = evaluate(points[low]) @ weights[low]
        jacobi = jacobi_matrix(points[low], weights[low], min(24, int(low.sum())))
        for size in range(1, len(jacobi) + 1):
            nodes, masses = gauss_rule(jacobi[:size, :size], weights[low].sum())
            if np.all(np.abs(evaluate(nodes) @ masses - exact) <= allowed):
                if size + np.sum(~low) < best[0].size:
                    best = np.append(points[~low], nodes), np.append(weights[~low], masses)
                break
    return best
