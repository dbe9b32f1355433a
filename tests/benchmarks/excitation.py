"""`python -m tests.benchmarks.excitation ARM...`: designed motions beside motions drawn at random.

Each random motion is a Fourier series with coefficients from a normal distribution, around a middle
that can be held, as large as the same bounds allow. The table goes into docs/record-a-motion.md.
"""

from __future__ import annotations

import sys
import time

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.files import markdown_table
from fotsmc_pin.references import Excitation
from fotsmc_pin.references import excitation_design as design

ARMS = ("panda", "ur5", "kinova", "xarm7", "z1", "so100", "asr_twodof", "two_link")
DRAWN = 9


def condition(cost, coefficients):
    """Return the condition number of the scaled base regressor."""
    sizes = np.linalg.eigvalsh(cost.information(coefficients))
    return float(np.sqrt(sizes[-1] / sizes[0]))


def row(name):
    """Return the row of an arm."""
    arm = fp.load_arm(name)
    started = time.process_time()
    motion = Excitation(arm)
    took = time.process_time() - started
    cost, rng = motion._cost, np.random.default_rng(1)
    drawn = [
        design.inside(cost, design.random_motion(cost, rng, design._middle(cost, rng)))
        for _ in range(DRAWN)
    ]
    conditions = [condition(cost, one) for one in drawn]
    spreads = [np.sqrt(design.variance(cost, one)) for one in drawn]
    spread = np.sqrt(design.variance(cost, motion._coefficients))
    seen = motion.seen
    return (
        name,
        f"{took:.1f}",
        f"{len(cost.regressor.base.T)}",
        f"{motion.condition_number:.3g}",
        f"{np.median(conditions):.3g}",
        f"{np.median(conditions) / motion.condition_number:.2g}",
        f"{min(conditions) / motion.condition_number:.2g}",
        f"{np.median(spreads) / spread:.2g}",
        f"{sum(item.well for item in seen)} of {sum(item.acts for item in seen)}",
    )


def main():
    """Print the table."""
    head = (
        "arm",
        "processor time [s]",
        "base parameters",
        "condition number",
        "random, median",
        "ratio",
        "ratio to the best of nine",
        "ratio of deviations",
        "parameters visible",
    )
    rows = []
    for name in sys.argv[1:] or ARMS:
        rows.append(row(name))
        print(rows[-1], flush=True)  # noqa: T201
    print(markdown_table(head, rows, "l" + "r" * (len(head) - 1)))  # noqa: T201


if __name__ == "__main__":
    main()
