"""`plot_front`: what a search of gains found between small errors and quiet torques."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.view.style import new_figure, paper_style, save_figure, spans_decades

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence
    from pathlib import Path


def plot_front(
    points: Sequence[tuple[float, float]], path: str | os.PathLike[str], error: str
) -> list[Path]:
    """Draw error over torque variation, on logarithmic axes where they span decades.

    Args:
        points: pairs of error and torque variation [N·m/s].
        path: file with the ending .svg, .png or .pdf.
        error: what the error is, with its unit.

    Returns:
        The files that were written.
    """
    with paper_style():
        figure, axes = new_figure(row_height=2.4)
        front = axes[0, 0]
        errors, variations = np.array(sorted(points)).T
        front.plot(variations, errors, "o-", markersize=3.0)
        front.set_xscale("log" if spans_decades(variations) else "linear")
        front.set_yscale("log" if spans_decades(errors) else "linear")
        front.set_xlabel("torque variation [N·m/s]")
        front.set_ylabel(error)
    return save_figure(figure, path)
