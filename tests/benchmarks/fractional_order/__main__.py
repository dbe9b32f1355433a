"""What the fractional order is worth: searches, held-out runs, verdict and figures.

    python -m tests.benchmarks.fractional_order run [PROBLEM...] [--seeds 1 2] [--learning]
    python -m tests.benchmarks.fractional_order unpack | pack | against [--folder FOLDER]
    python -m tests.benchmarks.fractional_order judge
    python -m tests.benchmarks.fractional_order figures

`run` goes on where it was stopped. `pack` adds what it has so far to
`docs/data/fractional_order`; `unpack` fills an empty folder from there, so that `run` goes on from
what is stored; `against` tells whether runs that were made anew came out as stored. From the stored
runs `judge` prints the tables of the page "What the fractional order is worth" and writes them
beside the data; `figures` draws its pictures. Both take a minute.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from fotsmc_pin.files import write_text
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS
from tests.benchmarks.fractional_order.figures import write_figures
from tests.benchmarks.fractional_order.held_out import DEFAULT, carry, judge_search
from tests.benchmarks.fractional_order.polishing import polish
from tests.benchmarks.fractional_order.searching import TRIALS, finish
from tests.benchmarks.fractional_order.settings import PROBLEMS
from tests.benchmarks.fractional_order.side_tables import all_tables
from tests.benchmarks.fractional_order.store import ARCHIVE, ROOT, Search, Store, load

OUT = ROOT / "out/fractional_order"


def study(
    store: Store,
    problems: list[str],
    seeds: list[int],
    learnings: list[bool],
    trials: int,
    further: str,
) -> None:
    """Search and judge: a problem is finished in all configurations before the next one begins."""
    for seed in seeds:
        for learning in learnings:
            for problem in problems:
                started = time.monotonic()
                searches = {
                    name: Search(problem, name, learning, seed)
                    for name in ("free", *CONFIGURATIONS)
                }
                found = {name: finish(search, store, trials) for name, search in searches.items()}
                default = found["free"][DEFAULT].outcome
                for name, search in searches.items():
                    if further == "carry":
                        carry(search, found[name], default, store)
                    elif further not in ("polish", "widen"):
                        long = further == "long"
                        judge_search(search, found[name], default, store, long=long)
                    elif further == "polish" or name != "pid":
                        polish(search, found[name], default, store, wide=further == "widen")
                took = time.monotonic() - started
                sys.stderr.write(
                    f"{time.strftime('%H:%M:%S')} seed {seed}, {problem}"
                    f"{', learning' if learning else ''}: {took:.0f} s\n"
                )


def main() -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.fractional_order")
    parser.add_argument("what", choices=("run", "unpack", "pack", "against", "judge", "figures"))
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=", ".join(PROBLEMS))
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--learning", choices=("both", "with", "without"), default="both")
    parser.add_argument("--trials", type=int, default=TRIALS)
    parser.add_argument(
        "--further",
        choices=("", "long", "carry", "polish", "widen"),
        default="",
        help="run held-out settings for longer; run designs found without learning with it; or go "
        "on from designs for the error alone, in the spans of the search or in wider ones",
    )
    parser.add_argument("--folder", type=Path, default=OUT, help="of the files under way")
    given = parser.parse_args()
    unknown = set(given.problems) - set(PROBLEMS)
    if unknown:
        parser.error(f"unknown problems: {', '.join(sorted(unknown))}")
    if given.what == "run":
        learnings = {"both": [False, True], "with": [True], "without": [False]}[given.learning]
        problems = given.problems or [*PROBLEMS]
        study(Store(given.folder), problems, given.seeds, learnings, given.trials, given.further)
    elif given.what == "pack":
        Store(given.folder).pack()
    elif given.what == "unpack":
        Store(given.folder).unpack()
    elif given.what == "against":
        sys.stdout.write(Store(given.folder).against())
    elif given.what == "judge":
        for name, table in all_tables(load()).items():
            write_text(ARCHIVE / f"{name}.txt", table)
            sys.stdout.write(f"{name}\n\n{table}\n")
    else:
        write_figures(load())


if __name__ == "__main__":
    main()
