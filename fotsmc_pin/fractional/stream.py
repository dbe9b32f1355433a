"""The state of a fractional operator that takes one sample at a time."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.checks import finite_number, finite_vector
from fotsmc_pin.compiled import restricted
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional.advance import advance_checked, advance_many
from fotsmc_pin.fractional.layout import (
    FIRST_MODE,
    HEADER,
    HEADER_COLUMNS,
    MODES,
    PERIOD,
    ROWS,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array


class Stream:
    """`n` signals that one fractional operator processes; memory and cost never grow.

    Made by `FractionalDerivative.stream` and `FractionalIntegral.stream`. Compiled code passes
    `coefficients` and `memory` to `fractional.advance`.

    Attributes:
        coefficients: table of the operator, read-only, shared by all its streams.
        memory: the whole state, (n, columns). Copying it saves the stream, and copying it back
            restores the stream bit for bit.
    """

    __slots__ = ("_dt", "coefficients", "memory")

    def __init__(self, coefficients: Array, n: int) -> None:
        """Start `n` signals, with `coefficients` laid out as in `fractional.layout`."""
        self._dt = float(coefficients[HEADER, PERIOD])
        self.coefficients = coefficients
        self.memory = np.zeros((n, FIRST_MODE + int(coefficients[HEADER, MODES])))

    @property
    def n(self) -> int:
        """Number of signals."""
        return self.memory.shape[0]

    @property
    def dt(self) -> float:
        """Nominal period [s]."""
        return self._dt

    def update(self, x: ArrayLike, dt: float | None = None) -> Array:
        """Take the next sample and return the value of the operator there.

        Args:
            x: the sample, (n,).
            dt: measured time since the last sample [s]; the nominal period if left out. It is not
                used for the first sample.

        Returns:
            The value, (n,), a new array.

        Raises:
            ArgumentError: the sample is not finite or has another shape, or the period is not
                above zero. The state stays as it was.
        """
        period = self._dt if dt is None else finite_number("dt", dt, above=0)
        y = np.empty(self.memory.shape[0])
        advance = _advance()
        try:
            taken = advance(self.coefficients, self.memory, x, period, y)  # type: ignore[arg-type]
        except (AttributeError, TypeError):  # not a plain array of floats
            taken = False
        if not taken:
            sample = finite_vector("x", x, self.n)
            advance(self.coefficients, self.memory, sample, period, y)
        return y

    def update_many(self, samples: ArrayLike, dt: ArrayLike | None = None) -> Array:
        """Take many samples at once, as `update` would one by one.

        Args:
            samples: one sample per row, (N, n).
            dt: measured time before each sample [s], (N,) or one for all.

        Returns:
            One value per row, (N, n).

        Raises:
            ArgumentError: as `update`; the state stays as it was before the first row.
        """
        rows = np.array(samples, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != self.n:
            raise ArgumentError("samples", rows.shape, f"give one sample of {self.n} per row")
        if not np.isfinite(rows).all():
            raise ArgumentError("samples", samples, "every entry must be finite")
        periods = np.empty(len(rows))
        try:
            periods[:] = self.dt if dt is None else dt
        except (TypeError, ValueError):
            raise ArgumentError("dt", dt, f"give one period, or {len(rows)} of them") from None
        if not (np.isfinite(periods) & (periods > 0)).all():
            raise ArgumentError("dt", dt, "every period must be above 0 s")
        values = np.empty_like(rows)
        advance_many(self.coefficients, self.memory, rows, periods, values)
        return values

    def reset(self) -> None:
        """Forget everything; the next sample is the first one again."""
        self.memory[:] = 0.0

    def copy(self) -> Stream:
        """Return an independent stream in the same state."""
        twin = Stream(self.coefficients, self.n)
        twin.memory[:] = self.memory
        return twin

    def __copy__(self) -> Stream:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Stream:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as arrays, with the coefficients, which stay read-only."""
        return _revived, (self.to_arrays(),)

    def to_arrays(self) -> dict[str, Array]:
        """Return the state as plain arrays, to be kept in any file."""
        return {"coefficients": self.coefficients.copy(), "memory": self.memory.copy()}

    def from_arrays(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Restore what `to_arrays` gave; the stream continues bit for bit.

        The coefficients are included, since those of another machine may differ in the last bit.

        Raises:
            ArgumentError: the arrays belong to another operator or another number of signals.
        """
        missing = {"coefficients", "memory"} - set(arrays)
        if missing:
            raise ArgumentError(
                "arrays", sorted(arrays), f"give {' and '.join(sorted(missing))} too"
            )
        coefficients = np.array(arrays["coefficients"], dtype=np.float64)
        memory = np.array(arrays["memory"], dtype=np.float64)
        if memory.shape != self.memory.shape:
            raise ArgumentError("memory", memory.shape, f"give shape {self.memory.shape}")
        if not np.isfinite(memory).all():
            raise ArgumentError("memory", memory, "every entry must be finite")
        if coefficients.shape != self.coefficients.shape or not np.allclose(
            coefficients, self.coefficients, rtol=1e-9, atol=1e-300
        ):
            raise ArgumentError("coefficients", coefficients, "give those of this very operator")
        coefficients.setflags(write=False)
        self.coefficients = coefficients
        self.memory[:] = memory


def _revived(arrays: Mapping[str, Array]) -> Stream:
    """Return the stream that these arrays were taken from."""
    coefficients = arrays["coefficients"]
    coefficients.setflags(write=False)
    stream = Stream(coefficients, len(arrays["memory"]))
    stream.memory[:] = arrays["memory"]
    return stream


@cache
def _advance() -> Callable[[Array, Array, Array, float, Array], bool]:
    """Return `advance_checked`, compiled for the arrays of a stream and refusing all others."""
    stream = Stream(np.zeros((ROWS, HEADER_COLUMNS)), 1)
    stream.coefficients.setflags(write=False)
    row = np.zeros(1)
    return restricted(advance_checked, stream.coefficients, stream.memory, row, 1.0, row)
