"""What is searched: three laws, with and without learning, and where their gains are looked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import fotsmc_pin as fp
from fotsmc_pin.control.robust_gains import reach_of_limits
from fotsmc_pin.evaluation.stress.baseline import SEARCH_SPACE
from fotsmc_pin.evaluation.tuning import Span
from tests.benchmarks.fractional_order.settings import DT

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm

SHARED = {
    "A": Span(low=5.0, high=200.0, logarithmic=True),
    "theta": Span(low=4.0, high=200.0, logarithmic=True),
    "observer": Span(low=15.0, high=400.0, logarithmic=True),
    "integral": Span(low=1.0, high=5000.0, logarithmic=True),
    "reach_scale": Span(low=0.1, high=4.0, logarithmic=True),
    "approach_rate": Span(low=2.0, high=40.0, logarithmic=True),
}
"""Gains of `RobustFONFTSM` that are searched at either order. `reach_scale` multiplies the reach
that follows from the velocity limits and the other gains; all others keep their defaults."""
OWN = {
    "alpha": Span(low=0.0, high=0.9, logarithmic=False),
    "tempering": Span(low=2.0, high=80.0, logarithmic=True),
}
"""Searched besides where the order is free; of order 0 the tempered operators are the identity."""
BEARS = (0.3, 3.0)
"""Ratios of inertia with which every law is trusted when it learns: those of a law of which nothing
is known; to find each trial's own takes longer than its run."""
START = {
    "A": 28.0,
    "theta": 21.0,
    "observer": 88.0,
    "integral": 50.0,
    "reach_scale": 1.0,
    "approach_rate": 8.0,
    "alpha": 0.3,
    "tempering": 14.0,
}
"""The law's defaults."""
PID_START = {"kp": 300.0, "kd": 30.0, "ki": 1000.0}
GAINS = (*PID_START, *START)
"""Names of all gains that are stored."""


class Robust(fp.RobustFONFTSM):
    """The law without its warnings about the arm, whose check takes as long as a quarter run."""

    def review(self) -> None:
        """Take the arm and the gains as they are."""


class Pid(fp.ComputedTorque):
    """Computed torque without these warnings."""

    def review(self) -> None:
        """Take the arm and the gains as they are."""


@dataclass(frozen=True, kw_only=True)
class Configuration:
    """A law, and the gains of it that are searched.

    Attributes:
        title: in tables and figures.
        space: where each gain is looked for.
        start: the first trial.
        order: the order where it is fixed.
    """

    title: str
    space: Mapping[str, Span]
    start: Mapping[str, float]
    order: float | None = None

    def controller(self, arm: Arm, gains: Mapping[str, float], *, learning: bool) -> Any:
        """Return the controller with these gains."""
        law: Any
        if "kp" in gains:
            law = Pid(arm, DT, **gains)
        else:
            given = dict(gains)
            scale = given.pop("reach_scale")
            if self.order is not None:
                given |= {"alpha": self.order, "tempering": START["tempering"]}
            reach = scale * reach_of_limits(
                arm=arm,
                dt=DT,
                bandwidth=1.0,
                alpha=given["alpha"],
                tempering=given["tempering"],
                A=given["A"],
                lam=2.0,
            )
            law = Robust(arm, DT, reach=reach, **given)
        return fp.ModelLearning(law, delay=1, bears=BEARS) if learning else law


CONFIGURATIONS = {
    "integer": Configuration(
        title="α = 0",
        space=SHARED,
        start={name: START[name] for name in SHARED},
        order=0.0,
    ),
    "free": Configuration(title="α free", space=SHARED | OWN, start=START),
    "pid": Configuration(title="PID", space=SEARCH_SPACE, start=PID_START),
}
