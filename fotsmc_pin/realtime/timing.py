"""`Timing`: how well a loop in wall-clock time kept its time."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


PERCENTILES = (50.0, 90.0, 99.0, 99.9, 100.0)


@dataclass(frozen=True, kw_only=True)
class Timing:
    """How well the loop kept its time.

    Attributes:
        ticks: number of ticks.
        missed: ticks whose torque was written after the next tick was due.
        latency: 50th, 90th, 99th, 99.9th and 100th percentile of the time from a tick's due time
            to its torque being written [s].
        compute: the same percentiles of the time that one update of the controller took [s].
        period: mean measured period [s].
        stopped: why the safe stop was on at the end; None if it was not.
    """

    ticks: int
    missed: int
    latency: tuple[float, ...]
    compute: tuple[float, ...]
    period: float
    stopped: str | None

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return asdict(self)

    def __str__(self) -> str:
        """Return a few lines to print."""
        lines = [
            f"{self.ticks} ticks of {1e3 * self.period:.3f} ms, {self.missed} deadlines missed"
        ]
        for name, values in (("latency", self.latency), ("compute", self.compute)):
            shown = "  ".join(
                f"p{percentile:g} {1e6 * value:.0f}"
                for percentile, value in zip(PERCENTILES, values, strict=True)
            )
            lines.append(f"{name} [µs]: {shown}")
        if self.stopped:
            lines.append(f"stopped: {self.stopped}")
        return "\n".join(lines)


def percentiles(values: Array) -> tuple[float, ...]:
    """Return the `PERCENTILES` of `values`."""
    return tuple(float(value) for value in np.percentile(values, PERCENTILES))
