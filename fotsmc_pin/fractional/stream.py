"""The state of a fractional operator that runs along with its samples."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fotsmc_pin.checks import finite_vector
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional.advance import advance
from fotsmc_pin.fractional.layout import FIRST_MODE, HEADER, MODES, PERIOD

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    Array: TypeAlias = NDArray[np.float64]


class Stream:
    """`n` signals on their way through one fractional operator; memory and cost never grow.

    Attributes:
        coefficients: read-only table of the operator, shared by all its streams.
        memory: the whole state, (n, columns). Copying it saves the stream, copying it back restores
            it bit for bit.
    """

    __slots__ = ("_period", "coefficients", "memory")

    def __init__(self, coefficients: Array, n: int) -> None:
        self.coefficients = coefficients
        self.memory = np.zeros((n, FIRST_MODE + int(coefficients[HEADER, MODES])))
        self._period = float(coefficients[HEADER, PERIOD])

    @property
    def n(self) -> int:
        """Number of signals."""
        return self.memory.shape[0]

    def update(self, x: ArrayLike, dt: float | None = None) -> Array:
        """Take the next sample and return the operator's value there.

        Args:
            x: the sample, (n,).
            dt: measured time since the last sample [s]; the nominal period if left out. The first
                sample has none before it: its `dt` is not used.

        Returns:
            The value, (n,), a new array.

        Raises:
            ArgumentError: the sample is not finite or has another shape, or the period is not
                positive. The state stays as it was.
        """
        sample = finite_vector("x", x, self.memory.shape[0])
        if dt is None:
            dt = self._period
        elif not 0.0 < dt < math.inf:
            raise ArgumentError("dt", dt, "give the time since the last sample, above 0 s")
        y = np.empty_like(sample)
        advance(self.coefficients, self.memory, sample, dt, y)
        return y

    def reset(self) -> None:
        """Forget everything; the next sample is a first one."""
        self.memory[:] = 0.0

    def copy(self) -> Stream:
        """Return an independent stream in the same state."""
        twin = Stream(self.coefficients, self.n)
        twin.memory[:] = self.memory
        return twin

    def to_arrays(self) -> dict[str, Array]:
        """Return the state as plain arrays, to be kept in any file."""
        return {"coefficients": self.coefficients.copy(), "memory": self.memory.copy()}

    def from_arrays(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over a state that `to_arrays` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: the arrays come from another operator or another number of signals.
        """
        memory = np.asarray(arrays["memory"], dtype=np.float64)
        if memory.shape != self.memory.shape:
            raise ArgumentError("memory", memory.shape, f"give shape {self.memory.shape}")
        self.memory[:] = memory
