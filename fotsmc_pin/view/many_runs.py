"""Figures of many runs: how one of their metrics is spread, and the front of a search of gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.view.palette import COLORS
from fotsmc_pin.view.style import legend_above, new_figure, paper_style, spans_decades

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike


def distribution_figure(
    groups: Mapping[str, ArrayLike], quantity: str, unit: str, *, scale: float = 1.0
) -> Figure:
    """Return the share of runs that stay at or below each value, one curve for each group.

    The empirical distribution hides no run and needs no bins: the dot at its end is the worst
    case. A curve that ends below 100 % belongs to runs whose value is infinite.

    Args:
        groups: name of a group, and the value of each of its runs.
        quantity: what is shown.
        unit: its unit after scaling.
        scale: factor from the values to that unit.

    Raises:
        ArgumentError: a group without runs.
    """
    figure, axes = new_figure(width="column", row_height=2.4)
    panel = axes[0, 0]
    with paper_style():
        for color, (name, given) in zip(COLORS * len(groups), groups.items(), strict=False):
            values = np.sort(np.asarray(given, dtype=np.float64))
            if not values.size:
                raise ArgumentError("groups", name, "give at least one run")
            share = 100.0 * np.arange(1, values.size + 1) / values.size
            finite = np.isfinite(values)
            x, y = scale * values[finite], share[finite]
            panel.step(x, y, where="post", color=color, label=f"{name} ({values.size})")
            panel.plot(x[-1:], y[-1:], "o", color=color, markersize=3.5)
        if spans_decades(np.concatenate([np.asarray(given, float) for given in groups.values()])):
            panel.set_xscale("log")
        panel.set_xlabel(f"{quantity} [{unit}]")
        panel.set_ylabel("runs at or below [%]")
        panel.set_ylim(0.0, 102.0)
        legend_above(figure, panel)
    return figure


def front_figure(points: Sequence[tuple[float, float]], error: str) -> Figure:
    """Return error over torque variation, on logarithmic axes where they span decades.

    Args:
        points: pairs of error and torque variation [N·m/s].
        error: what the error is, with its unit.
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
    return figure
