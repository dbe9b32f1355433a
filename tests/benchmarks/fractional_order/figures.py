"""The figures of the page, from stored runs; one for each question."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from fotsmc_pin.view import new_figure, paper_style, save_figure
from fotsmc_pin.view.palette import BLUE, GREEN, GREY, VERMILLION
from tests.benchmarks.fractional_order.comparing import (
    BUDGETS,
    ERROR,
    THIRD,
    compare,
    designs,
    done_problems,
    held_out,
    seeds_of,
)
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS
from tests.benchmarks.fractional_order.judging import front
from tests.benchmarks.fractional_order.settings import PROBLEMS
from tests.benchmarks.fractional_order.side_tables import chosen_orders
from tests.benchmarks.fractional_order.store import ROOT, Search
from tests.benchmarks.fractional_order.tables import LEARNING, POOLED, pooled, worlds

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from fotsmc_pin.types import Array
    from tests.benchmarks.fractional_order.judging import Interval
    from tests.benchmarks.fractional_order.store import Results

IMAGES = ROOT / "docs/images"
COLORS = {"integer": BLUE, "free": VERMILLION, "pid": GREEN}
AXIS = {"variation": "torque variation [N·m/s]", "peak": "peak torque [N·m]"}
COLUMNS = 4
PARTS = ((1.0, 1.5, 2.0, 3.0, 5.0, 7.0), (1.0, 3.0), (1.0,))
"""Parts of a decade that are labelled, from the finest on."""
MOST_LABELS = 4
FARTHEST = 100.0
"""Errors are shown up to so many times the smallest held-out error of a panel's law."""


def write_figures(results: Results, folder: Path = IMAGES) -> None:
    """Write all figures."""
    for question in BUDGETS:
        for learning in (False, True):
            if done_problems(results, learning):
                name = f"order_{question}{'_learning' if learning else ''}.svg"
                save_figure(front_figure(results, question, learning), folder / name)
    save_figure(ratio_figure(results), folder / "order_ratios.svg")
    save_figure(order_figure(results), folder / "order_chosen.svg")


def front_figure(results: Results, question: str, learning: bool) -> Figure:
    """Return a panel per arm: fronts of the searches, and what their designs do held out."""
    problems = done_problems(results, learning)
    rows = -(-(len(problems) + 1) // COLUMNS)
    with paper_style():
        figure, _ = new_figure(rows, COLUMNS, width="page", row_height=1.6)
        figure.clear()  # Its panels share their axis; each arm has its own.
        panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for problem, panel in zip(problems, panels, strict=False):
            _fronts(results, problem, question, learning, panel)
        for panel in panels[len(problems) :]:
            panel.set_axis_off()
        last = panels[len(problems)]
        handles = [
            *(
                Line2D([], [], color=COLORS[name], marker="o", markersize=3.5, label=each.title)
                for name, each in CONFIGURATIONS.items()
            ),
            Line2D([], [], color=GREY, linewidth=0.7, alpha=0.6, label="in the search"),
            Line2D([], [], color=GREY, marker="o", markersize=3.5, label="held out"),
        ]
        last.legend(handles=handles, loc="center", title=LEARNING[learning], title_fontsize=8.0)
        figure.supxlabel(AXIS[question], fontsize=8.0)
        figure.supylabel("tail RMS error [mrad]", fontsize=8.0)
    return figure


def ratio_figure(results: Results) -> Figure:
    """Return the ratios of held-out errors, free order over order 0, with their intervals."""
    problems = [*[p for p in PROBLEMS if p in done_problems(results, False)], POOLED]
    with paper_style():
        figure, axes = new_figure(1, 2, width="page", row_height=2.9)
        for panel, question in zip(axes[0], BUDGETS, strict=True):
            for learning in worlds(results):
                shift = 0.14 - 0.28 * learning if len(worlds(results)) > 1 else 0.0
                found = [_ratio(results, problem, question, learning) for problem in problems]
                places = -np.arange(len(problems)) + shift
                kept = [k for k, each in enumerate(found) if each is not None]
                if not kept:
                    continue
                values = np.array([found[k] for k in kept]).reshape(-1, 3)
                panel.errorbar(
                    values[:, 0],
                    places[kept],
                    xerr=np.abs(values[:, 1:] - values[:, :1]).T,
                    fmt="s" if learning else "o",
                    color=VERMILLION if learning else BLUE,
                    markersize=3.5,
                    elinewidth=1.0,
                    label=LEARNING[learning],
                )
            panel.axvline(1.0, color=GREY, linewidth=0.8)
            panel.set_xscale("log")
            panel.set_yticks(-np.arange(len(problems)), problems)
            panel.get_yticklabels()[-1].set_fontweight("bold")
            panel.set_title(f"equal {'peak torque' if question == 'peak' else 'torque variation'}")
            panel.set_xlabel("error with α free over error with α = 0")
            _label_decades(panel.xaxis)
        if len(worlds(results)) > 1:
            axes[0, 0].legend(loc="best")
    return figure


def order_figure(results: Results) -> Figure:
    """Return the orders at which the searches with a free order ended, by budget."""
    budgets = [budget for question in BUDGETS.values() for budget in question]
    with paper_style():
        figure, axes = new_figure(1, 1, width="page", row_height=2.0)
        panel = axes[0, 0]
        for learning in worlds(results):
            shift = 0.26 * learning - 0.13 if len(worlds(results)) > 1 else 0.0
            for place, budget in enumerate(budgets):
                found = chosen_orders(results, learning, budget)
                if len(found):
                    panel.plot(
                        np.full(len(found), place + shift),
                        found,
                        "s" if learning else "o",
                        color=VERMILLION if learning else BLUE,
                        markersize=3.0,
                        alpha=0.7,
                        label=LEARNING[learning] if place == 0 else None,
                    )
                    panel.plot(
                        place + shift + np.array([-0.1, 0.1]),
                        [np.median(found)] * 2,
                        color="black",
                        linewidth=1.4,
                    )
        panel.set_xticks(range(len(budgets)), [budget.replace(" ", "\n× ") for budget in budgets])
        panel.set_ylabel("order α")
        panel.set_ylim(-0.03, 0.93)
        if len(worlds(results)) > 1:
            panel.set_ylim(-0.03, 1.1)  # Room for the legend above all orders.
            panel.legend(loc="upper right", ncols=2)
    return figure


def _fronts(results: Results, problem: str, question: str, learning: bool, panel: Axes) -> None:
    column, shown = THIRD[question], []
    for name in CONFIGURATIONS:
        rows: list[dict[str, Array]] = []
        for seed in seeds_of(results, problem, learning):
            search = Search(problem, name, learning, seed)
            points = np.array([trial.outcome[:3] for trial in results.trials[search]])
            pairs = points[:, (column, ERROR)]
            best = pairs[front(pairs)]
            panel.step(
                best[:, 0],
                1e3 * best[:, 1],
                where="post",
                color=COLORS[name],
                linewidth=0.7,
                alpha=0.5,
            )
            means = {
                budget: _middle(held_out(results, search, number))
                for budget, number in designs(results, search).items()
                if budget in BUDGETS[question]
            }
            rows.append(means)
        for budget in BUDGETS[question]:
            found = [means[budget] for means in rows if budget in means]
            if found:
                shown.append((name, np.exp(np.mean(np.log(found), axis=0))))
    for name in CONFIGURATIONS:
        line = np.array([point for owner, point in shown if owner == name]).reshape(-1, 3)
        panel.plot(line[:, column], 1e3 * line[:, ERROR], "o-", color=COLORS[name], markersize=3.0)
    errors = 1e3 * np.array([point[ERROR] for owner, point in shown if owner != "pid"])
    across = np.array([point[column] for _, point in shown])
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_ylim(0.4 * errors.min(), FARTHEST * errors.min())
    panel.set_xlim(0.7 * across.min(), 1.4 * across.max())
    for axis in (panel.xaxis, panel.yaxis):
        _label_decades(axis)
    panel.set_title(problem)


def _label_decades(axis: Axis) -> None:
    """Write some of each decade as plain numbers, as many as there is room for."""
    low, high = axis.get_view_interval()
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)))
    for parts in PARTS:
        ticks = [part * 10.0**k for k in decades for part in parts if low <= part * 10.0**k <= high]
        if len(ticks) <= MOST_LABELS:
            break
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _middle(rows: Array) -> Array:
    """Return the geometric mean over the settings, of torques over those that were not lost."""
    return np.asarray(np.exp(np.nanmean(np.log(rows), axis=0)))


def _ratio(results: Results, problem: str, question: str, learning: bool) -> Interval | None:
    budgets = BUDGETS[question]
    if problem == POOLED:
        return pooled(results, learning, "free", "integer", budgets)
    if problem not in done_problems(results, learning):
        return None
    found = compare(results, problem, learning, "free", "integer", budgets)
    return None if found is None else found.ratio
