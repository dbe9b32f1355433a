"""What the streams are held against: closed forms, and formulas that keep the whole history."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, TypeAlias

import mpmath
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]


@cache
def _integral_of_exponential(order: float, rate: complex, t: float) -> complex:
    """`I^α e^{λt} = t^α/Γ(1+α) 1F1(1; 1+α; λt)`, by mpmath."""
    value = mpmath.hyp1f1(1, 1 + order, rate * t)
    return complex(value) * t**order / math.gamma(1 + order)


@dataclass(frozen=True)
class Power:
    """`t^p`."""

    power: float

    def __call__(self, t: Array) -> Array:
        return t**self.power

    def derivative(self, order: float, t: Array) -> Array:
        gammas = math.gamma(self.power + 1) / math.gamma(self.power + 1 - order)
        return gammas * t ** (self.power - order)

    def integral(self, order: float, t: Array) -> Array:
        return self.derivative(-order, t)


@dataclass(frozen=True)
class Wave:
    """`Re(c e^{λt})`."""

    factor: complex
    rate: complex

    def __call__(self, t: Array) -> Array:
        return np.real(self.factor * np.exp(self.rate * t))

    def derivative(self, order: float, t: Array) -> Array:
        """Caputo's."""
        inner = [_integral_of_exponential(1 - order, self.rate, float(s)) for s in t]
        return np.real(self.factor * self.rate * np.array(inner))

    def integral(self, order: float, t: Array) -> Array:
        inner = [_integral_of_exponential(order, self.rate, float(s)) for s in t]
        return np.real(self.factor * np.array(inner))


FUNCTIONS = {
    "t^2": Power(2.0),
    "t^1.5": Power(1.5),
    "sin 10t": Wave(-1j, 10j),
    "e^-t": Wave(1.0, -1.0),
    "cos 7t e^-t": Wave(1.0, -1.0 + 7j),
}


def instants(count: int, number: int) -> NDArray[np.intp]:
    """Sample numbers at which a closed form is evaluated: all of the first 20, then spread out."""
    spread = np.unique(np.rint(np.linspace(20, count, number)).astype(np.intp))
    return np.concatenate([np.arange(1, 20), spread])


def mittag_leffler(order: float, z: float) -> float:
    """`E_α(z)` for `z < 0` and `0 < α < 1`, from its integral over a positive measure."""
    root = (-z) ** (1 / order)
    cosine, sine = math.cos(math.pi * order), math.sin(math.pi * order)

    def integrand(u: mpmath.mpf) -> mpmath.mpf:
        v = mpmath.e**u  # r^α
        return mpmath.e ** (-root * v ** (1 / order)) * v / (v * v + 2 * v * cosine + 1)

    knots = [-50, -20, -10, -5, -2, 0, 2, 5, 10, 20, 50]
    return float(sine / (math.pi * order) * mpmath.quad(integrand, knots))


def grunwald_letnikov(order: float, x: Array, dt: float, tempering: float = 0.0) -> Array:
    """Full history, for the derivative (`order > 0`) and the integral (`order < 0`)."""
    ages = np.arange(1, len(x))
    weights = np.cumprod(np.append(1.0, 1.0 - (order + 1.0) / ages))
    weights *= np.exp(-tempering * dt * np.arange(len(x))) / dt**order
    return np.array([weights[: i + 1][::-1] @ x[: i + 1] for i in range(len(x))])


def l1_derivative(order: float, x: Array, t: Array) -> Array:
    """Full-history L1 on any grid: Caputo's derivative of the piecewise linear interpolant."""
    slopes = np.diff(x) / np.diff(t)
    values = np.zeros(len(x))
    for n in range(1, len(x)):
        ages = (t[n] - t[: n + 1]) ** (1 - order) / math.gamma(2 - order)
        values[n] = slopes[:n] @ (ages[:-1] - ages[1:])
    return values


def trapezoidal_integral(order: float, x: Array, t: Array) -> Array:
    """Full-history integral of the piecewise linear interpolant, on any grid."""
    values = np.zeros(len(x))
    slopes = np.diff(x) / np.diff(t)
    for n in range(1, len(x)):
        ages = t[n] - t[: n + 1]
        first = ages**order / math.gamma(1 + order)
        second = ages ** (1 + order) / math.gamma(2 + order)
        values[n] = x[0] * first[0] + slopes[:n] @ (second[:-1] - second[1:])
    return values
