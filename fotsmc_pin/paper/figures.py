"""The paper's figures, drawn from this project's own runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.paper.experiments import ALPHAS
from fotsmc_pin.view import (
    comparison_figure,
    save_figure,
    signal_figure,
    torque_figure,
    tracking_figure,
    velocity_figure,
)

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from fotsmc_pin.simulation import Recording


RIVALS = {
    "proposed, tuned": "two_link/variation/AdaptiveFONFTSM, α = 0.1",
    "[20], integer order": "two_link/variation/ContinuousTSM",
    "second order": "two_link/variation/SuperTwistingSMC",
}
"""Laws of figures 8 and 9, tuned by the same search under the same peak torque and variation."""


def draw_figures(
    recordings: Mapping[str, Recording], contest: Mapping[str, Recording], folder: Path
) -> list[Path]:
    """Write figures 2 to 9 into `folder`, each as SVG and PNG, and return the files."""
    paper = recordings["paper"]
    orders = {
        f"α = {alpha:g}": recordings["paper" if alpha == 0.1 else f"alpha_{alpha:g}"]
        for alpha in ALPHAS
    }
    rivals = {"proposed, paper's gains": paper} | {
        name: contest[key] for name, key in RIVALS.items() if key in contest
    }
    figures = {
        "figure_2_positions": tracking_figure(paper),
        "figure_3_velocities": velocity_figure(paper),
        "figure_4_torques": torque_figure(paper),
        "figure_4_torques_with_boundary_layer": torque_figure(recordings["boundary_layer"]),
        "figure_5_estimates": signal_figure(
            paper, "b_hat", labels=(("B̂0", "N·m"), ("B̂1", "N·m·s/rad"))
        ),
        "figure_6_surfaces": signal_figure(
            paper, "s", labels=(("S1", "rad/s¹·¹"), ("S2", "rad/s¹·¹"))
        ),
        "figure_7_orders": comparison_figure(orders),
        "figure_8_positions_of_rivals": comparison_figure(rivals),
        "figure_9_velocities_of_rivals": comparison_figure(
            rivals, quantities=("velocity error", "torque")
        ),
    }
    return [file for name, figure in figures.items() for file in save_figure(figure, folder / name)]
