"""The tables of the page on single searches, orders, defaults and what was run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.files import markdown_table
from tests.benchmarks.fractional_order.comparing import (
    BUDGETS,
    compare,
    compare_defaults,
    designs,
    done_problems,
    held_out,
    seeds_of,
)
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS
from tests.benchmarks.fractional_order.further_tables import longer, polished, with_learning
from tests.benchmarks.fractional_order.held_out import DEFAULT
from tests.benchmarks.fractional_order.judging import paired_interval, pooled_interval
from tests.benchmarks.fractional_order.searching import TRIALS
from tests.benchmarks.fractional_order.settings import PAPER
from tests.benchmarks.fractional_order.store import Search
from tests.benchmarks.fractional_order.tables import (
    LEARNING,
    NOTHING,
    PAIRS,
    POOLED,
    hypervolumes,
    per_arm,
    per_budget,
    ratio_text,
    worlds,
)

if TYPE_CHECKING:
    from fotsmc_pin.types import Array
    from tests.benchmarks.fractional_order.store import Results


def per_seed(results: Results, pair: str) -> str:
    """Return a line per arm and world, a column per seed: the ratio of errors by one search.

    Below each world all arms but the paper's case, of those that were searched with the seed.
    """
    ours, others = PAIRS[pair]
    seeds = sorted({search.seed for search in results.trials})
    rows = []
    for learning in worlds(results):
        last: list[list[Array]] = [[] for _ in BUDGETS for _ in seeds]
        for problem in done_problems(results, learning):
            done = seeds_of(results, problem, learning, (ours, others))
            cells = [f"{problem}, {LEARNING[learning]}"]
            for budgets in BUDGETS.values():
                for seed in seeds:
                    found = None
                    if seed in done:
                        found = compare(
                            results, problem, learning, ours, others, budgets, seeds=[seed]
                        )
                    if found is not None and problem != PAPER:
                        last[len(cells) - 1].append(found.differences)
                    cells.append(NOTHING if found is None else ratio_text(found.ratio))
            rows.append(cells)
        pooled = [
            ratio_text(pooled_interval(groups).mapped(np.exp)) if groups else NOTHING
            for groups in last
        ]
        rows.append([f"**{POOLED}, {LEARNING[learning]}**", *pooled])
    head = [f"{question}, seed {seed}" for question in BUDGETS for seed in seeds]
    return markdown_table(["arm", *head], rows, "l" + "r" * len(head))


def orders(results: Results) -> str:
    """Return a line per budget: the orders that the search with a free order ended at."""
    rows = []
    for budget in (*BUDGETS["variation"], *BUDGETS["peak"]):
        cells = [budget.replace(" ", " × ")]
        for learning in worlds(results):
            found = chosen_orders(results, learning, budget)
            if len(found):
                low, middle, high = np.quantile(found, (0.0, 0.5, 1.0))
                cells.append(f"{middle:.2f} ({low:.2f} to {high:.2f})")
            else:
                cells.append(NOTHING)
        rows.append(cells)
    head = [LEARNING[learning] for learning in worlds(results)]
    return markdown_table(["budget", *head], rows, "l" + "r" * len(head))


def chosen_orders(results: Results, learning: bool, budget: str) -> Array:
    """Return the order of each design that the search with a free order has for a budget."""
    found = []
    for problem in done_problems(results, learning):
        for seed in seeds_of(results, problem, learning):
            search = Search(problem, "free", learning, seed)
            number = designs(results, search).get(budget)
            if number is not None:
                found.append(results.trials[search][number].gains["alpha"])
    return np.array(found)


def defaults(results: Results) -> str:
    """Return a line per arm: order 0.3 over order 0, all other gains at their defaults."""
    rows = []
    for problem in done_problems(results, False):
        cells = [problem]
        for learning in worlds(results):
            found = compare_defaults(results, problem, learning)
            for column in range(3):
                if found is None:
                    cells.append(NOTHING)
                else:
                    interval = paired_interval(found[:, column])
                    cells.append(ratio_text(interval.mapped(np.exp)))
        rows.append(cells)
    what = ("error", "variation", "peak")
    head = [f"{each}, {LEARNING[learning]}" for learning in worlds(results) for each in what]
    return markdown_table(["arm", *head], rows, "l" + "r" * len(head))


def errors(results: Results, budget: str) -> str:
    """Return a line per arm: held-out errors of each configuration at a budget [mrad]."""
    rows = []
    for problem in done_problems(results, False):
        cells = [problem]
        for learning in worlds(results):
            cells.append(_default_text(results, problem, learning))
            for name in CONFIGURATIONS:
                logs, lost = [], 0
                for seed in seeds_of(results, problem, learning):
                    search = Search(problem, name, learning, seed)
                    number = designs(results, search).get(budget)
                    if number is not None:
                        found = held_out(results, search, number)
                        logs.append(np.log(1e3 * found[:, 0]))
                        lost += int(np.isnan(found[:, 1]).sum())
                text = f"{math.exp(np.mean(logs)):.3g}" if logs else NOTHING
                cells.append(text + (f" ({lost} lost)" if lost else ""))
        rows.append(cells)
    head = [
        f"{title}, {LEARNING[learning]}"
        for learning in worlds(results)
        for title in ("defaults", *(each.title for each in CONFIGURATIONS.values()))
    ]
    return markdown_table(["arm", *head], rows, "l" + "r" * len(head))


def _default_text(results: Results, problem: str, learning: bool) -> str:
    """Return the error of the law with its defaults, the mean over the held-out settings [mrad]."""
    seeds = seeds_of(results, problem, learning)
    if not seeds:
        return NOTHING
    found = held_out(results, Search(problem, "free", learning, seeds[0]), DEFAULT)
    return f"{1e3 * math.exp(np.mean(np.log(found[:, 0]))):.3g}"


def counts(results: Results) -> str:
    """Return what was run, in a line per kind of search."""
    rows = []
    for learning in (False, True):
        for seed in (1, 2, 3):
            for name in CONFIGURATIONS:
                whole = [
                    search
                    for search, trials in results.trials.items()
                    if search[1:] == (name, learning, seed) and len(trials) >= TRIALS
                ]
                if whole:
                    trials = sum(len(results.trials[search]) for search in whole)
                    runs = sum(len(results.held_out.get(search, {})) for search in whole)
                    cells = [CONFIGURATIONS[name].title, LEARNING[learning], str(seed)]
                    rows.append([*cells, str(len(whole)), str(trials), str(runs)])
    further = [search for search in results.trials if " from " in search.configuration]
    if further:
        trials = sum(len(results.trials[search]) for search in further)
        runs = sum(len(results.held_out.get(search, {})) for search in further)
        rows.append(
            ["further trials", LEARNING[False], "1", str(len(further)), str(trials), str(runs)]
        )
    runs = sum(len(kept) for search, kept in results.held_out.items() if "found" in search[1])
    if runs:
        rows.append(["found without learning", LEARNING[True], "1", NOTHING, NOTHING, str(runs)])
    head = ["configuration", "", "seed", "searches", "trials", "held-out runs"]
    return markdown_table(head, rows, "llrrrr")


def all_tables(results: Results) -> dict[str, str]:
    """Return every table of the page by its name."""
    order = "order free over order 0"
    made = {"counts": counts(results), "orders": orders(results), "defaults": defaults(results)}
    made |= {f"order_{question}": per_arm(results, order, question) for question in BUDGETS}
    made |= {
        f"pid_{question}": per_arm(results, "PID over order free", question) for question in BUDGETS
    }
    made |= {
        "budgets": per_budget(results, order),
        "seeds": per_seed(results, order),
        "hypervolumes": hypervolumes(results, order),
        "errors_variation": errors(results, "variation 1"),
        "longer": longer(results),
        "with_learning": with_learning(results),
        "polished": polished(results, order),
    }
    return made
