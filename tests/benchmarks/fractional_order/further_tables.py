"""The tables of the page on what was tried after the searches: further trials, longer runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.files import markdown_table
from tests.benchmarks.fractional_order.comparing import (
    compare,
    compare_carried,
    compare_polished,
    done_problems,
    seeds_of,
)
from tests.benchmarks.fractional_order.held_out import CARRIED, LONG_BUDGET, SETTINGS
from tests.benchmarks.fractional_order.judging import pooled_interval
from tests.benchmarks.fractional_order.polishing import POLISHED
from tests.benchmarks.fractional_order.settings import LONG
from tests.benchmarks.fractional_order.store import Search
from tests.benchmarks.fractional_order.tables import NOTHING, PAIRS, POOLED, ratio_text

if TYPE_CHECKING:
    from tests.benchmarks.fractional_order.comparing import Pair
    from tests.benchmarks.fractional_order.store import Results


def longer(results: Results) -> str:
    """Return a line per arm: the ratios of errors from 1 to 2 s, and from 3 to 4 s, at a budget."""
    sines, rows = range(0, SETTINGS, 2), []
    for problem in done_problems(results, False):
        search = Search(problem, "free", False, seeds_of(results, problem, False)[0])
        if not any(k >= LONG for _, k in results.held_out[search]):
            continue
        cells = [problem]
        for ours, others in (("free", "integer"), ("pid", "free")):
            for settings in (sines, [LONG + k for k in sines]):
                found = compare(
                    results,
                    problem,
                    False,
                    ours,
                    others,
                    [LONG_BUDGET],
                    seeds=[search.seed],
                    settings=settings,
                )
                cells.append(NOTHING if found is None else ratio_text(found.ratio))
        rows.append(cells)
    head = [
        f"{pair}, {span}"
        for pair in ("α free over α = 0", "PID over α free")
        for span in ("1 to 2 s", "3 to 4 s")
    ]
    return markdown_table(["arm", *head], rows, "lrrrr")


def polished(results: Results, pair: str) -> str:
    """Return a line per arm and budget: the ratio before and after further trials."""
    ours, others = PAIRS[pair]
    rows = []
    for search in list(results.trials):
        if search.configuration != "free":
            continue
        for budget in POLISHED:
            pairs = {
                wide: compare_polished(results, search, ours, others, budget, wide=wide)
                for wide in (False, True)
            }
            known = next((found[0] for found in pairs.values() if found is not None), None)
            if known is not None:
                name = search.problem + (", learning" if search.learning else "")
                texts = [ratio_text(known.ratio)]
                for found in pairs.values():
                    texts += [NOTHING] * 2 if found is None else _cells(found[1])
                rows.append([f"{name}, seed {search.seed}", budget.replace(" ", " × "), *texts])
    head = [
        f"{what}{where}"
        for where in (", polished", ", polished in wider spans")
        for what in ("error", "variation")
    ]
    return markdown_table(["arm", "budget", "error", *head], rows, "llrrrrr")


def _cells(pair: Pair) -> list[str]:
    return [ratio_text(pair.ratio), f"{np.exp(np.nanmean(pair.other)):.2f}"]


def with_learning(results: Results) -> str:
    """Return a line per arm: ratios with learning, by designs that were found without it."""
    pairs, rows = (("free", "integer"), ("pid", "free")), []
    for problem in done_problems(results, False):
        cells = [problem]
        for ours, others in pairs:
            for budget in CARRIED:
                found = compare_carried(results, problem, ours, others, budget)
                cells += [NOTHING] * 2 if found is None else _cells(found)
        if any(cell != NOTHING for cell in cells[1:]):
            rows.append(cells)
    last = [f"**{POOLED}**"]
    for ours, others in pairs:
        for budget in CARRIED:
            every = [
                compare_carried(results, problem, ours, others, budget)
                for problem in done_problems(results, False)
            ]
            groups = [found.differences for found in every if found is not None]
            text = ratio_text(pooled_interval(groups).mapped(np.exp)) if groups else NOTHING
            last += [text, ""]
    head = [
        f"{title} at {budget.replace(' ', ' × ')}" if what == "error" else what
        for title in ("α free over α = 0", "PID over α free")
        for budget in CARRIED
        for what in ("error", "variation")
    ]
    return markdown_table(["arm", *head], [*rows, last], "l" + "r" * len(head))
