"""What happens on the surface `S = 0`: its stability (Remark 2), and the error's decay there."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array


SMALLEST_ORDER = 0.01
"""Below this the integral of `surface_decay` needs too many points; 0 itself needs none."""

DIGITS = 36.0
"""The integral leaves out what is below `e^{-36}`, which is rounding."""


def sector_margin(matrix: ArrayLike, order: float) -> float:
    """Return by how much `D^order x = matrix x` keeps clear of Matignon's unstable sector [rad].

        margin = min |arg spec(matrix)| - order π/2

    The system is asymptotically stable where this is positive (Remark 2).

    Args:
        matrix: (n, n), or a number.
        order: order of the derivative, in (0, 2).

    Raises:
        ArgumentError: an argument is unusable.
    """
    order = checks.finite_number("order", order, above=0.0, below=2.0)
    square = np.atleast_2d(np.asarray(matrix, dtype=np.float64))
    if square.ndim != 2 or square.shape[0] != square.shape[1] or not np.isfinite(square).all():
        raise ArgumentError("matrix", matrix, "give a square matrix of finite numbers")
    eigenvalues = np.linalg.eigvals(square)
    # Zero lies on the boundary of every sector and belongs to the unstable side.
    angles = np.where(eigenvalues == 0.0, 0.0, np.abs(np.angle(eigenvalues)))
    return float(angles.min() - order * math.pi / 2.0)


def surface_margin(alpha: float, A: ArrayLike) -> float:
    """Return the margin of the linear part of the surface [19] to Matignon's sector [rad].

    On `S = 0` the linear part is `D^{1+α} e = -A e`. With positive gains the margin is
    `(1 - α) π/2` whatever they are: it falls as the order rises, and `1 - 2 margin/π` is `α` again.
    Tempered operators keep at least this margin, as `arg s (s + σ)^α ≤ (1 + α) π/2` on the
    imaginary axis.

    Args:
        alpha: order `α` of the surface, in [0, 1).
        A: linear gains of the surface, a number or (nv,).

    Raises:
        ArgumentError: an argument is unusable.
    """
    alpha = checks.finite_number("alpha", alpha, at_least=0.0, below=1.0)
    return sector_margin(-np.diag(np.atleast_1d(np.asarray(A, dtype=np.float64))), 1.0 + alpha)


def surface_decay(
    t: ArrayLike, *, alpha: float, a: float, e_start: float, ed_start: float = 0.0
) -> Array:
    """Return the error (N,) that the linear surface `D^α ė + a e = 0` leaves at the times `t`.

        e(t) = e(0) E_{1+α}(-a t^{1+α}) + ė(0) t E_{1+α,2}(-a t^{1+α})

    with Mittag-Leffler's function and the Caputo derivative. Unless `α = 0` it ends in an
    algebraic tail: it decays like `e(0) t^{-(1+α)}`, or like `ė(0) t^{-α}`, and never reaches zero
    (reading R8). The terminal term `λ sig(e)^{p/q}` and tempering are left out.

    The function is evaluated as its pair of poles and the integral along its branch cut; see
    Gorenflo and Mainardi, Fractional calculus: integral and differential equations of fractional
    order, 1997.

    Args:
        t: times (N,) or a number, at least 0 [s].
        alpha: order `α`, 0 or in [0.01, 1).
        a: gain `a` of the surface [s^-(1+α)].
        e_start: `e(0)` [rad].
        ed_start: `ė(0)` [rad/s]; with `α = 0` it follows from `e(0)` and is not used.

    Raises:
        ArgumentError: an argument is out of its range.
    """
    alpha = checks.finite_number("alpha", alpha, at_least=0.0, below=1.0)
    if 0.0 < alpha < SMALLEST_ORDER:
        raise ArgumentError("alpha", alpha, f"give 0, or at least {SMALLEST_ORDER:g}")
    a = checks.finite_number("a", a, above=0.0)
    e_start = checks.finite_number("e_start", e_start)
    ed_start = checks.finite_number("ed_start", ed_start)
    times = np.atleast_1d(np.asarray(t, dtype=np.float64))
    times = checks.finite_vector("t", times, times.size)
    if (times < 0.0).any():
        raise ArgumentError("t", t, "every time must be at least 0")
    if alpha == 0.0:
        return e_start * np.exp(-a * times)
    unit = a ** (1.0 / (1.0 + alpha))
    scaled = unit * times
    decay = e_start * _decay_of_start(scaled, alpha)
    if ed_start != 0.0:
        decay += ed_start / unit * _decay_of_speed(scaled, alpha)
    return decay


def _decay_of_start(t: Array, alpha: float) -> Array:
    """`E_β(-t^β)` with `β = 1 + α`."""
    beta = 1.0 + alpha
    pole = np.exp(1j * math.pi / beta)
    poles: Array = 2.0 / beta * np.exp(pole * t).real
    log_r, step = _cut(alpha, slowest=beta)
    return poles + _along_cut(t, log_r, _density(log_r, beta, 0), step)


def _decay_of_speed(t: Array, alpha: float) -> Array:
    """`t E_{β,2}(-t^β)` with `β = 1 + α`, the integral of `E_β(-t^β)`."""
    beta = 1.0 + alpha
    pole = np.exp(1j * math.pi / beta)
    poles: Array = 2.0 / beta * (np.exp(pole * t) / pole).real
    log_r, step = _cut(alpha, slowest=alpha)
    return poles - _along_cut(t, log_r, _density(log_r, beta, 1), step)


def _cut(alpha: float, slowest: float) -> tuple[Array, float]:
    """Return points `log r` along the cut, and their step.

    The trapezoid rule errs by `e^{-2π d/step}`, `d` being the distance of the density's poles from
    the real axis of `log r`. Towards 0 the density falls like `r^slowest`.
    """
    distance = math.pi * alpha / (1.0 + alpha)
    step = 2.0 * math.pi * distance / DIGITS
    return np.arange(-DIGITS / slowest, DIGITS / (1.0 + alpha), step), step


def _density(log_r: Array, beta: float, power: int) -> Array:
    """Spectral density of `E_β(-t^β)` times `r^{1-power}`, as a function of `log r`."""
    scale: Array = (
        np.exp((power + beta) * log_r)
        + 2.0 * math.cos(beta * math.pi) * np.exp(power * log_r)
        + np.exp((power - beta) * log_r)
    )
    return math.sin(beta * math.pi) / (math.pi * scale)


def _along_cut(t: Array, log_r: Array, density: Array, step: float) -> Array:
    """Integral of `e^{-rt}` times the density over `log r`."""
    r = np.exp(log_r)
    return np.array([step * np.dot(np.exp(-r * time), density) for time in t])
