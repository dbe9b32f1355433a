"""The runs behind the paper's figures and claims, and the metrics that verdicts follow from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.analysis import summarize
from fotsmc_pin.paper import two_link

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from fotsmc_pin.simulation import Recording

ALPHAS = (0.01, 0.1, 0.3, 0.5, 0.9)
"""Orders of Fig. 7. The paper names only 0.1."""

BOUNDARY_LAYER = 0.1
"""Width of the saturation that replaces the sign where chattering is judged [rad s^-(1+α)]."""

SURFACE_REACHED = 0.05
"""The surface counts as reached where `‖S‖` stays below this [rad s^-(1+α)]."""


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """One run of the two-link case.

    Attributes:
        title: what is special about it, in plain words.
        gains: single gains that differ from the paper's.
        elbow_mass: reading R3.
        substeps: RK4 steps in a tick; two give the same verdicts as the ten of the paper's own run.
    """

    title: str
    gains: Mapping[str, Any]
    elbow_mass: str = "printed"
    substeps: int = 2


EXPERIMENTS: dict[str, Experiment] = {
    "paper": Experiment(title="as printed", gains={}, substeps=two_link.SUBSTEPS),
    "boundary_layer": Experiment(
        title=f"sign replaced by a saturation, boundary layer {BOUNDARY_LAYER:g}",
        gains={"switching": "saturation", "boundary_layer": BOUNDARY_LAYER},
    ),
    "R1_direct": Experiment(
        title="R1: adaptation rate υ, not υ⁻¹", gains={"adaptation_rate": "direct"}
    ),
    "R2_power_1.1": Experiment(
        title="R2: p/q = 1.1, which obeys 1 < p/q < 2", gains={"power": 1.1}
    ),
    "R3_m2_1.5": Experiment(
        title="R3: true m2 = 1.5 kg, as in the literature", gains={}, elbow_mass="literature"
    ),
    "R5_outside": Experiment(
        title="R5: M0 outside the fractional integral", gains={"inertia": "outside"}
    ),
    "R6_mu_0.5": Experiment(title="R6: μ = 0.5 in place of ≈ 1", gains={"mu": 0.5}),
    "no_bounds": Experiment(
        title="estimates that start at 0", gains={"B0_start": 0.0, "B1_start": 0.0}
    ),
    "theta_2.5": Experiment(title="θ = 2.5", gains={"theta": 2.5}),
    "theta_10": Experiment(title="θ = 10", gains={"theta": 10.0}),
    **{
        f"alpha_{alpha:g}": Experiment(title=f"α = {alpha:g}", gains={"alpha": alpha})
        for alpha in ALPHAS
        if alpha != 0.1
    },
}
"""Every run of the proposed controller, by name."""


def run_all(report: Callable[[float], None]) -> dict[str, Recording]:
    """Run every experiment; `report` is told the fraction done."""
    recordings = {}
    for k, (name, experiment) in enumerate(EXPERIMENTS.items()):
        recordings[name] = two_link.run(
            two_link.controller(**experiment.gains),
            elbow_mass=experiment.elbow_mass,
            substeps=experiment.substeps,
        )
        report((k + 1) / len(EXPERIMENTS))
    return recordings


def measure(rec: Recording) -> dict[str, Any]:
    """Return the run's summary, and what the claims need besides, as plain data."""
    tail = rec.t >= 0.5 * rec.t[-1]
    last_second = rec.t >= rec.t[-1] - 1.0
    s_norm = np.linalg.norm(rec.signals["s"], axis=1)
    b_hat = rec.signals["b_hat"]
    last_outside = int(np.flatnonzero(s_norm >= SURFACE_REACHED)[-1])
    reached = float(rec.t[last_outside + 1]) if last_outside + 1 < len(rec) else float("inf")
    return summarize(rec).as_dict() | {
        "tail_exponent": _tail_exponent(rec),
        "velocity_rms_tail": float(np.sqrt(np.mean(np.sum(rec.e_dot[tail] ** 2, axis=1)))),
        "surface_start_norm_1": float(np.abs(rec.signals["s"][0]).sum()),
        "surface_reached": reached,
        "surface_rms_tail": float(np.sqrt(np.mean(s_norm[tail] ** 2))),
        "b_hat_end": [float(b) for b in b_hat[-1]],
        "b_hat_last_second_growth": [float(g) for g in np.ptp(b_hat[last_second], axis=0)],
    }


def _tail_exponent(rec: Recording) -> float:
    """Slope of `log ‖e‖` over `log t` in the second half of the run."""
    tail = rec.t >= 0.5 * rec.t[-1]
    slope, _ = np.polyfit(np.log(rec.t[tail]), np.log(rec.error_norm[tail]), 1)
    return float(slope)
