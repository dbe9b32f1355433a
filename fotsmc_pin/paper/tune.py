"""`python -m fotsmc_pin.paper.tune`: tune every contestant anew and store what was found.

With names as arguments only those laws are tuned; the others keep what is stored.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from joblib import Parallel, delayed

from fotsmc_pin.files import write_json
from fotsmc_pin.paper.contest import (
    MATCHES,
    PEAK,
    SEED,
    TRIALS,
    TUNING_DURATION,
    VARIATION,
    Contestant,
    contestants,
    tune,
)

STORE = Path(__file__).with_name("tuned_gains.json")


def main(names: list[str], jobs: int = 2) -> None:
    """Tune the contestants of these laws, or all, and write the store."""
    entries = [entry for entry in contestants() if not names or entry.law in names]
    outcomes = Parallel(n_jobs=jobs, verbose=10)(delayed(_tuned)(entry) for entry in entries)
    matches = {match: {} for match in MATCHES}
    if STORE.exists():
        matches |= json.loads(STORE.read_text(encoding="utf-8"))["matches"]
    for entry, outcome in zip(entries, outcomes, strict=True):
        matches[entry.match][entry.name] = outcome
    rule = {
        "cost": "integral of t times the error norm, over the first seconds",
        "duration": TUNING_DURATION,
        "peak_torque": PEAK,
        "torque_variation": VARIATION,
        "trials": TRIALS,
        "seed": SEED,
    }
    write_json(STORE, {"rule": rule, "matches": matches})


def _tuned(entry: Contestant) -> dict[str, object]:
    outcome = tune(entry)
    return {"law": entry.law, "gains": outcome.gains, "cost": outcome.cost}


if __name__ == "__main__":
    main(sys.argv[1:])
