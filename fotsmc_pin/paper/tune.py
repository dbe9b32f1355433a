"""`python -m fotsmc_pin.paper.tune [NAME ...]`: tune the contestants anew and store what is found.

With names of laws only those are tuned; the others keep their stored gains.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed

from fotsmc_pin.files import write_json
from fotsmc_pin.paper.cases import CASES
from fotsmc_pin.paper.contest import (
    SEED,
    TRIALS,
    TUNING_DURATION,
    Contestant,
    contestants,
    tune_contestant,
)

STORE = Path(__file__).with_name("tuned_gains.json")


def main(names: list[str], jobs: int = 2) -> None:
    """Tune the contestants of these laws, or all, and write the store after each."""
    entries = [entry for entry in contestants() if not names or entry.law in names]
    outcomes = json.loads(STORE.read_text("utf-8"))["outcomes"] if STORE.exists() else {}
    rule = {
        "cost": "integral of t times the error norm over the first seconds",
        "duration": TUNING_DURATION,
        "limits": {
            name: {"peak_torque": case.peak_torque, "torque_variation": case.torque_variation}
            for name, case in CASES.items()
        },
        "trials": TRIALS,
        "seed": SEED,
    }
    found = Parallel(n_jobs=jobs, return_as="generator", verbose=10)(
        delayed(_tuned)(entry) for entry in entries
    )
    for entry, outcome in zip(entries, found, strict=True):
        outcomes[entry.key] = outcome
        write_json(STORE, {"rule": rule, "outcomes": outcomes})


def _tuned(entry: Contestant) -> dict[str, Any]:
    outcome = tune_contestant(entry)
    return {"gains": outcome.gains, "cost": outcome.cost}


if __name__ == "__main__":
    main(sys.argv[1:])
