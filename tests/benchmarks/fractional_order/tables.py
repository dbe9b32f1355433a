"""The tables of the page, from stored runs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.files import markdown_table
from tests.benchmarks.fractional_order.comparing import (
    BUDGETS,
    compare,
    compare_fronts,
    done_problems,
)
from tests.benchmarks.fractional_order.judging import Interval, pooled_interval
from tests.benchmarks.fractional_order.settings import PAPER

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tests.benchmarks.fractional_order.store import Results

NOTHING = "–"
LEARNING = {False: "without learning", True: "with learning"}
PAIRS = {
    "order free over order 0": ("free", "integer"),
    "PID over order 0": ("pid", "integer"),
    "PID over order free": ("pid", "free"),
}
POOLED = "all arms"


def worlds(results: Results) -> list[bool]:
    """Return whether there are searches without learning, and with it, in this order."""
    return [learning for learning in LEARNING if done_problems(results, learning)]


def ratio_text(interval: Interval | None) -> str:
    """Return "0.93 (0.85 to 1.02)", in bold where 1 lies outside."""
    if interval is None:
        return NOTHING
    text = f"{interval.value:.3g}"
    if math.isfinite(interval.low + interval.high):
        text += f" ({interval.low:.3g} to {interval.high:.3g})"
    return f"**{text}**" if interval.excludes(1.0) else text


def pooled(
    results: Results, learning: bool, ours: str, others: str, budgets: Sequence[str]
) -> Interval | None:
    """Return the ratio of errors over all arms but the paper's case, with its interval."""
    groups = [
        found.differences
        for problem in done_problems(results, learning)
        if problem != PAPER
        and (found := compare(results, problem, learning, ours, others, budgets)) is not None
    ]
    return pooled_interval(groups).mapped(np.exp) if groups else None


def per_arm(results: Results, pair: str, question: str) -> str:
    """Return a line per arm: the ratio of errors over all budgets of a question."""
    ours, others = PAIRS[pair]
    budgets, rows = BUDGETS[question], []
    for problem in done_problems(results, False):
        cells = [problem]
        for learning in worlds(results):
            found = (
                compare(results, problem, learning, ours, others, budgets)
                if problem in done_problems(results, learning)
                else None
            )
            cells += _cells(found)
        rows.append(cells)
    last = [f"**{POOLED}**"]
    for learning in worlds(results):
        last += [ratio_text(pooled(results, learning, ours, others, budgets)), "", ""]
    return markdown_table(
        [
            "arm",
            *(
                f"{what}, {LEARNING[learning]}"
                for learning in worlds(results)
                for what in ("error", question, "budgets")
            ),
        ],
        [*rows, last],
        "lrrr" + "rrr" * (len(last) > 4),
    )


def per_budget(results: Results, pair: str) -> str:
    """Return a line per budget: the ratio of errors over all arms that can meet it."""
    ours, others = PAIRS[pair]
    rows = []
    for budget in (*BUDGETS["variation"], *BUDGETS["peak"]):
        cells = [budget.replace(" ", " × ")]
        for learning in worlds(results):
            arms = [
                problem
                for problem in done_problems(results, learning)
                if problem != PAPER
                and compare(results, problem, learning, ours, others, [budget]) is not None
            ]
            cells += [ratio_text(pooled(results, learning, ours, others, [budget])), str(len(arms))]
        rows.append(cells)
    head = [f"{what}, {LEARNING[x]}" for x in worlds(results) for what in ("error", "arms")]
    return markdown_table(["budget", *head], rows, "l" + "r" * len(head))


def hypervolumes(results: Results, pair: str) -> str:
    """Return a line per arm: by how much one held-out front dominates more than the other."""
    ours, others = PAIRS[pair]
    rows = []
    for problem in done_problems(results, False):
        cells = [problem]
        for learning in worlds(results):
            for question in BUDGETS:
                found = None
                if problem in done_problems(results, learning):
                    found = compare_fronts(results, problem, learning, ours, others, question)
                cells.append(_difference_text(found))
        rows.append(cells)
    head = [f"{question}, {LEARNING[x]}" for x in worlds(results) for question in BUDGETS]
    return markdown_table(["arm", *head], rows, "l" + "r" * len(head))


def _cells(pair: object) -> list[str]:
    if pair is None:
        return [NOTHING] * 3
    other = float(np.exp(np.nanmean(pair.other)))  # type: ignore[attr-defined]
    return [ratio_text(pair.ratio), f"{other:.2f}", str(len(pair.budgets))]  # type: ignore[attr-defined]


def _difference_text(interval: Interval | None) -> str:
    if interval is None:
        return NOTHING
    text = f"{interval.value:+.2f} ({interval.low:+.2f} to {interval.high:+.2f})"
    return f"**{text}**" if interval.excludes(0.0) else text
