"""The figure of a loop's margins: Nyquist plot, sensitivity, and decay against the true inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis.loop_curves import growth_rates, return_ratio
from fotsmc_pin.analysis.margins import HEAVIEST, LIGHTEST
from fotsmc_pin.view.figures import LIMIT, REFERENCE
from fotsmc_pin.view.palette import BLACK, COLORS, GREEN, PURPLE, VERMILLION
from fotsmc_pin.view.style import legend_above, new_figure, paper_style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fotsmc_pin.analysis import InertiaRatios, Margins

RATES, RATIOS = 600, 160
LOWEST_RATE = 1.0
BAR, BAR_STEP = 9.0, 3.5
"""Where the arms' own ratios are drawn, above the curves [1/s]."""


def margins_figure(
    loops: Mapping[str, Margins], arms: Mapping[str, InertiaRatios] | None = None
) -> Figure:
    """Return three panels that say how robust loops are.

    On the left the return ratio `L(jω)` with the unit circle, from which it must stay clear at -1;
    in the middle the sensitivity `|1 / (1 + L)|`; on the right the growth rate of the mode that
    decays least against the ratio of true to nominal inertia, with the stable range shaded.

    Args:
        loops: name -> what `margins` returned; the range that is shaded is that of the narrowest.
        arms: name -> ratios of a true arm, to be marked on the right.
    """
    arms = arms or {}
    figure, _ = new_figure(width="page", row_height=2.5)
    with paper_style():
        figure.clear()  # The panels share no axis.
        nyquist, sensitivity, growth = figure.subplots(1, 3)
        span = _span(loops, arms)
        for color, (name, found) in zip(COLORS, loops.items(), strict=False):
            dt = found.laws[0].dt
            rates = np.geomspace(LOWEST_RATE, 0.999 * np.pi / dt, RATES)
            for k, ratio in enumerate(return_ratio(found, rates)):
                label = name if k == 0 else None
                nyquist.plot(ratio.real, ratio.imag, color=color, label=label)
                sensitivity.plot(rates, 1.0 / np.abs(1.0 + ratio), color=color)
            m = np.geomspace(*span, RATIOS)
            growth.plot(m, growth_rates(found, m), color=color)
        _finish_nyquist(nyquist)
        sensitivity.axhline(2.0, **LIMIT)
        sensitivity.text(1.2 * LOWEST_RATE, 2.2, "common bound 2", fontsize=6.5, color=VERMILLION)
        sensitivity.set(xscale="log", yscale="log", ylim=(1e-3, 4.0))
        sensitivity.set(xlabel="frequency [rad/s]", ylabel="sensitivity $|S(j\\omega)|$ [–]")
        _finish_growth(growth, loops, arms, span)
        legend_above(figure, nyquist)
    return figure


def _finish_nyquist(panel: Axes) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    panel.plot(np.cos(turn), np.sin(turn), **REFERENCE)
    panel.plot([-1.0], [0.0], "+", color=VERMILLION, markersize=7, markeredgewidth=1.4)
    panel.annotate("−1", (-1.0, 0.0), (-4, 5), textcoords="offset points", ha="right", fontsize=7)
    panel.set(xlim=(-3.0, 1.5), ylim=(-2.25, 2.25), aspect="equal")
    panel.set(xlabel="real part of $L$ [–]", ylabel="imaginary part of $L$ [–]")


def _span(loops: Mapping[str, Margins], arms: Mapping[str, InertiaRatios]) -> tuple[float, float]:
    """Ratios of inertia that are shown: all edges and the arms' own, with room beside them."""
    ranges: list[Margins | InertiaRatios] = [*loops.values(), *arms.values()]
    low, highest = min(one.lowest for one in ranges), [one.highest for one in ranges]
    high = max([edge for edge in highest if edge < HEAVIEST], default=HEAVIEST)
    return max(0.5 * low, LIGHTEST), min(2.5 * max(high, 4.0), HEAVIEST)


def _finish_growth(
    panel: Axes,
    loops: Mapping[str, Margins],
    arms: Mapping[str, InertiaRatios],
    span: tuple[float, float],
) -> None:
    lowest = max(found.lowest for found in loops.values())
    highest = min(found.highest for found in loops.values())
    panel.axvspan(lowest, highest, color=GREEN, alpha=0.15, linewidth=0)
    panel.axhline(0.0, color=BLACK, linewidth=0.6)
    panel.set_title(f"stable from {lowest:.3g} to {highest:.3g}", fontsize=7, color=GREEN)
    for row, (name, ratios) in enumerate(arms.items()):
        height, ends = BAR + BAR_STEP * row, [ratios.lowest, ratios.highest]
        panel.plot(ends, [height, height], "|-", color=PURPLE, markersize=4)
        middle = min(max(float(np.sqrt(ends[0] * ends[1])), 4.0 * span[0]), 0.25 * span[1])
        panel.annotate(
            name,
            (middle, height),
            (0, 2.5),
            textcoords="offset points",
            ha="center",
            fontsize=6,
            color=PURPLE,
        )
    panel.set(xscale="log", xlim=span, ylim=(-16.0, BAR + BAR_STEP * len(arms)))
    panel.set(xlabel="true over nominal inertia $m$ [–]", ylabel="growth of the slowest mode [1/s]")
