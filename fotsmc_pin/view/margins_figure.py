"""The figure of a loop's margins: Nyquist plot, sensitivity, and decay against the true inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis.loop_curves import growth_rates, return_ratio
from fotsmc_pin.view.figures import LIMIT, REFERENCE
from fotsmc_pin.view.palette import BLACK, COLORS, GREEN, VERMILLION
from fotsmc_pin.view.style import legend_above, new_figure, paper_style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fotsmc_pin.analysis import InertiaRatios, Margins

RATES, RATIOS = 600, 160
LOWEST_RATE = 1.0
BAR = 10.5
"""Height at which the arm's own ratios are drawn, above the curves [1/s]."""


def margins_figure(loops: Mapping[str, Margins], ratios: InertiaRatios | None = None) -> Figure:
    """Return three panels that say how robust loops are.

    On the left the return ratio `L(jω)` with the unit circle, from which it must stay clear at -1;
    in the middle the sensitivity `|1 / (1 + L)|`; on the right the growth rate of the mode that
    decays least against the ratio of true to nominal inertia, with the stable range shaded.

    Args:
        loops: name -> what `margins` returned; the range that is shaded is that of the narrowest.
        ratios: of a true arm, to be marked on the right.
    """
    figure, _ = new_figure(width="page", row_height=2.5)
    with paper_style():
        figure.clear()  # The panels share no axis.
        nyquist, sensitivity, growth = figure.subplots(1, 3)
        for color, (name, found) in zip(COLORS, loops.items(), strict=False):
            dt = found.laws[0].dt
            rates = np.geomspace(LOWEST_RATE, 0.999 * np.pi / dt, RATES)
            for k, ratio in enumerate(return_ratio(found, rates)):
                label = name if k == 0 else None
                nyquist.plot(ratio.real, ratio.imag, color=color, label=label)
                sensitivity.plot(rates, 1.0 / np.abs(1.0 + ratio), color=color)
            _draw_growth(growth, found, ratios, color)
        _finish_nyquist(nyquist)
        sensitivity.axhline(2.0, **LIMIT)
        sensitivity.text(1.2 * LOWEST_RATE, 2.1, "common bound 2", fontsize=6.5, color=VERMILLION)
        sensitivity.set(xscale="log", yscale="log", ylim=(1e-3, 4.0))
        sensitivity.set(xlabel="frequency [rad/s]", ylabel="sensitivity $|S(j\\omega)|$ [–]")
        _finish_growth(growth, loops, ratios)
        legend_above(figure, nyquist)
    return figure


def _finish_nyquist(panel: Axes) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    panel.plot(np.cos(turn), np.sin(turn), **REFERENCE)
    panel.plot([-1.0], [0.0], "+", color=VERMILLION, markersize=7, markeredgewidth=1.4)
    panel.annotate("−1", (-1.0, 0.0), (-4, 5), textcoords="offset points", ha="right", fontsize=7)
    panel.set(xlim=(-3.0, 1.5), ylim=(-2.25, 2.25), aspect="equal")
    panel.set(xlabel="real part of $L$ [–]", ylabel="imaginary part of $L$ [–]")


def _span(loops: Mapping[str, Margins], ratios: InertiaRatios | None) -> tuple[float, float]:
    """Ratios of inertia that are shown: all edges and the arm's own, with room beside them."""
    ends = [edge for f in loops.values() for edge in (f.lowest, f.highest)]
    low, high = min(ends), max(edge for edge in ends if edge < 1e3 or edge == min(ends))
    if ratios is not None:
        low, high = min(low, ratios.lowest), max(high, ratios.highest)
    return max(0.5 * low, 1e-3), min(2.5 * max(high, 5.0), 1e3)


def _draw_growth(panel: Axes, found: Margins, ratios: InertiaRatios | None, color: str) -> None:
    low, high = _span({"": found}, ratios)
    m = np.geomspace(low, high, RATIOS)
    panel.plot(m, growth_rates(found, m), color=color)


def _finish_growth(panel: Axes, loops: Mapping[str, Margins], ratios: InertiaRatios | None) -> None:
    lowest = max(found.lowest for found in loops.values())
    highest = min(found.highest for found in loops.values())
    panel.axvspan(lowest, highest, color=GREEN, alpha=0.15, linewidth=0)
    panel.axhline(0.0, color=BLACK, linewidth=0.6)
    panel.set_title(f"stable from {lowest:.3g} to {highest:.3g}", fontsize=7, color=GREEN)
    if ratios is not None:
        ends = [ratios.lowest, ratios.highest]
        panel.plot(ends, [BAR, BAR], "|-", color=VERMILLION, markersize=7)
        text = f"this arm: {ends[0]:.3g} to {ends[1]:.3g}"
        middle = float(np.sqrt(ends[0] * ends[1]))
        panel.annotate(
            text,
            (middle, BAR),
            (0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=6.5,
            color=VERMILLION,
        )
    panel.set(xscale="log", xlim=_span(loops, ratios), ylim=(-16.0, 14.0))
    panel.set(xlabel="true over nominal inertia $m$ [–]", ylabel="growth of the slowest mode [1/s]")
