"""What a fractional operator is: its order, its clock, its accuracy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from fotsmc_pin.checks import choice, count, finite_number
from fotsmc_pin.fractional.coefficients import (
    SCHEMES,
    Plan,
    coefficient_table,
    sum_of_exponentials,
)
from fotsmc_pin.fractional.stream import Stream

if TYPE_CHECKING:
    from fotsmc_pin.fractional.exponential_sum import ExponentialSum
    from fotsmc_pin.fractional.grunwald_letnikov import WeightSum

DEFINITIONS = ("caputo", "riemann-liouville")


@dataclass(frozen=True, kw_only=True, repr=False)
class FractionalOperator(ABC):
    """What derivative and integral have in common."""

    order: float
    dt: float
    tolerance: float = 1e-8
    horizon: float = 1e3
    tempering: float = 0.0
    scheme: str = "linear"

    def __post_init__(self) -> None:
        """Check every argument, and that the tolerance can be kept up to the horizon."""
        dt = finite_number("dt", self.dt, above=0)
        checked = {
            "order": finite_number("order", self.order, at_least=0, at_most=1),
            "dt": dt,
            "tolerance": finite_number("tolerance", self.tolerance, at_least=1e-11, at_most=1e-2),
            "horizon": finite_number("horizon", self.horizon, at_least=2 * dt),
            "tempering": finite_number("tempering", self.tempering, at_least=0),
        }
        choice("scheme", self.scheme, tuple(SCHEMES))
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        coefficient_table(self._plan)

    @property
    @abstractmethod
    def _plan(self) -> Plan:
        """What the coefficients are made from."""

    @property
    def exponential_sum(self) -> ExponentialSum | WeightSum | None:
        """The sum of exponentials that carries the past, with its certificate.

        None for the orders 0 and 1, which are exact.
        """
        return sum_of_exponentials(self._plan)

    @property
    def certificate(self) -> float:
        """Largest relative error of the memory kernel, `dt` to `horizon`; 0 where it is exact."""
        found = self.exponential_sum
        return 0.0 if found is None else found.certificate

    def stream(self, n: int) -> Stream:
        """Return a fresh state for `n` signals."""
        return Stream(coefficient_table(self._plan), count("n", n))

    def __repr__(self) -> str:
        """Return the description and the certificate."""
        described = [f"{field.name}={getattr(self, field.name)!r}" for field in fields(self)]
        found = self.exponential_sum
        modes = 0 if found is None else found.modes
        kept = f"{modes} modes, certified to {self.certificate:.2g}"
        return f"{type(self).__name__}({', '.join(described)}): {kept}"


@dataclass(frozen=True, kw_only=True, repr=False)
class FractionalDerivative(FractionalOperator):
    """Derivative of order `α` of sampled signals, `(s + σ)^α` in the frequency domain.

    Caputo's definition, tempered:

        D^α x(t) = e^{-σt} ∫_0^t (t-τ)^{-α}/Γ(1-α) d/dτ[e^{στ} x(τ)] dτ.

    The start `x(0)`, the first sample, makes no difference: with `σ = 0` the derivative of a
    constant is 0, and so is that of any signal at its first sample. Riemann and Liouville's
    definition takes the signal as 0 before the first sample, and adds the answer to that step,
    `x(0) e^{-σt} t^{-α}/Γ(1-α)`. It is infinite at the first sample, where the stream gives 0.

    Order 0 is the identity in either definition. Caputo's derivative tends to `x - x(0)` instead
    as `α → 0`, so the two agree for signals that start at 0. Order 1 is the difference of the
    scheme's polynomial.

    Args:
        order: `α`, from 0 to 1.
        dt: nominal period [s].
        tolerance: relative error of the memory kernel, 1e-11 to 1e-2.
        horizon: age up to which the past is kept to the tolerance [s]; what is older fades out.
        tempering: `σ` [1/s]; the memory fades like `e^{-σt}`.
        scheme: "linear" (L1, the signal is linear between samples; error `O(dt^{2-α})`; the choice
            for measured signals, as it amplifies noise least), "quadratic" (a parabola through the
            last three samples; `O(dt^{3-α})` from the third sample on; for smooth signals), or
            "grunwald-letnikov" (the weights `(-1)^j binom(α, j) e^{-σ j dt} / dt^α`; `O(dt)`;
            for papers that define their operator so).
        definition: "caputo" or "riemann-liouville". Grünwald and Letnikov's own sum is the latter;
            "caputo" applies it to `x` less its start.

    Raises:
        ArgumentError: an argument is out of range, or the tolerance cannot be kept up to the
            horizon; the message says what would work.
    """

    definition: str = "caputo"

    def __post_init__(self) -> None:
        """Check every argument."""
        choice("definition", self.definition, DEFINITIONS)
        super().__post_init__()

    @property
    def _plan(self) -> Plan:
        return Plan(
            exponent=self.order or 1.0,
            differentiates=self.order > 0,
            from_rest=self.definition == "riemann-liouville",
            scheme=self.scheme,
            dt=self.dt,
            horizon=self.horizon,
            tolerance=self.tolerance,
            tempering=self.tempering,
        )


@dataclass(frozen=True, kw_only=True, repr=False)
class FractionalIntegral(FractionalOperator):
    """Integral of order `α` of sampled signals, `(s + σ)^{-α}` in the frequency domain.

    Riemann and Liouville's definition, tempered:

        I^α x(t) = ∫_0^t e^{-σ(t-τ)} (t-τ)^{α-1}/Γ(α) x(τ) dτ.

    It starts at 0 with the first sample. The sum of Grünwald and Letnikov counts the first sample
    like any other, and starts at `dt^α x(0)`. Order 0 is the identity, order 1 the trapezoidal rule
    in the linear scheme.

    Args:
        order: `α`, from 0 to 1.
        dt: nominal period [s].
        tolerance: relative error of the memory kernel, 1e-11 to 1e-2.
        horizon: age up to which the past is kept to the tolerance [s]; what is older fades out.
        tempering: `σ` [1/s]; the memory fades like `e^{-σt}`.
        scheme: "linear" (trapezoidal product integration, `O(dt^2)`), "quadratic" (`O(dt^3)`) or
            "grunwald-letnikov" (the weights `(-1)^j binom(-α, j) e^{-σ j dt} dt^α`, `O(dt)`).

    Raises:
        ArgumentError: an argument is out of range, or the tolerance cannot be kept up to the
            horizon; the message says what would work.
    """

    @property
    def _plan(self) -> Plan:
        return Plan(
            exponent=1.0 - self.order,
            differentiates=False,
            from_rest=False,
            scheme=self.scheme,
            dt=self.dt,
            horizon=self.horizon,
            tolerance=self.tolerance,
            tempering=self.tempering,
        )
