"""What a fractional operator is: its order, its clock, its accuracy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from fotsmc_pin.checks import choice, count, finite_number
from fotsmc_pin.fractional.coefficients import SCHEMES, coefficient_table
from fotsmc_pin.fractional.stream import Stream

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FractionalOperator(ABC):
    """What derivative and integral have in common."""

    order: float
    dt: float
    tolerance: float = 1e-8
    horizon: float = 1e3
    tempering: float = 0.0
    scheme: str = "linear"

    def __post_init__(self) -> None:
        checked = {
            "order": finite_number("order", self.order, at_least=0, at_most=1),
            "dt": finite_number("dt", self.dt, above=0),
            "tolerance": finite_number("tolerance", self.tolerance, at_least=1e-11, at_most=1e-2),
            "tempering": finite_number("tempering", self.tempering, at_least=0),
        }
        checked["horizon"] = finite_number("horizon", self.horizon, above=checked["dt"])
        choice("scheme", self.scheme, tuple(SCHEMES))
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        _ = self.coefficients

    @property
    @abstractmethod
    def coefficients(self) -> Array:
        """The read-only table that the compiled functions take."""

    def stream(self, n: int) -> Stream:
        """Return a fresh state for `n` signals."""
        return Stream(self.coefficients, count("n", n))

    def _table(self, exponent: float, differentiates: bool) -> Array:
        return coefficient_table(
            exponent=exponent,
            differentiates=differentiates,
            scheme=self.scheme,
            dt=self.dt,
            horizon=self.horizon,
            tolerance=self.tolerance,
            tempering=self.tempering,
        )


@dataclass(frozen=True, kw_only=True)
class FractionalDerivative(FractionalOperator):
    """Caputo derivative of order `α` of sampled signals."""

    @property
    def coefficients(self) -> Array:
        """The read-only table that the compiled functions take."""
        if self.order == 0.0:
            return self._table(1.0, False)
        return self._table(self.order, True)


@dataclass(frozen=True, kw_only=True)
class FractionalIntegral(FractionalOperator):
    """Riemann-Liouville integral of order `α` of sampled signals."""

    @property
    def coefficients(self) -> Array:
        """The read-only table that the compiled functions take."""
        return self._table(1.0 - self.order, False)
