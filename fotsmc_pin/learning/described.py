"""What `ModelLearning` says of itself, and what a recording of it holds."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.control.wrapper import Wrapper
from fotsmc_pin.learning.estimates import Estimate, Estimates

if TYPE_CHECKING:
    from fotsmc_pin.simulation import Recording

LABEL = " + learning"
"""What the name of a law gets that learns its model."""
KEY = "learning"
"""Where the metadata of a recording describe what was learnt."""


class Described(Wrapper):
    """A wrapped controller, described: its gains and preset, and for recordings a name and data."""

    controller: Any
    delay: int
    bears: tuple[float, float]

    @property
    def label(self) -> str:
        """The controller's name, and that it learns."""
        found = self.controller
        return f"{getattr(found, 'label', type(found).__name__)}{LABEL}"

    @property
    def about(self) -> dict[str, Any]:
        """Plain data for a recording's metadata: what is learnt, and what was believed of it.

        Under "learning": "delay" [ticks], "bears", and under "parameters", for each signal of
        estimates, lists by its columns: "of", "unit", "first_value" and "first_deviation".
        """
        parameters: dict[str, Any] = {}
        for row in self.estimates():
            columns = parameters.setdefault(
                row.group, {name: [] for name in ("of", "unit", "first_value", "first_deviation")}
            )
            for name, values in columns.items():
                values.append(getattr(row, name))
        return {
            KEY: {"delay": self.delay, "bears": [*self.bears], "parameters": parameters},
        }

    @abstractmethod
    def estimates(self) -> Estimates:
        """Return what is known of the arm by now."""


def recorded_estimates(rec: Recording, t: float | None = None) -> Estimates | None:
    """Return what was known of the arm at a time of a recorded run; None where nothing was learnt.

    Args:
        rec: a run of `ModelLearning`, or any other.
        t: time [s]; None for the end. The last row at or before it is taken.
    """
    about = rec.metadata.get(KEY)
    if not about or not len(rec):
        return None
    row = -1 if t is None else max(int(np.searchsorted(rec.t, t, side="right")) - 1, 0)
    return Estimates(
        tuple(
            Estimate(
                group=group,
                of=of,
                value=float(rec.signals[group][row, k]),
                deviation=float(rec.signals[f"{group}_deviation"][row, k]),
                first_value=first,
                first_deviation=doubt,
                unit=unit,
            )
            for group, columns in about["parameters"].items()
            for k, (of, unit, first, doubt) in enumerate(
                zip(
                    columns["of"],
                    columns["unit"],
                    columns["first_value"],
                    columns["first_deviation"],
                    strict=True,
                )
            )
        )
    )
