"""Time of a tick in C of what learns, at seven joints, and what it adds to a law.

`python -m tests.benchmarks.learning_ticks_in_c [SECONDS]` runs `RobustFONFTSM` in Python on the
stress plant of a Panda, with and without `ModelLearning`, repeats the ticks in C (`gcc -O2`), ten
times from the start, and prints for each tick of a window of four its time (the least of the ten
repeats, then the median and the largest over all such ticks), and the sizes of program and state.
The regressor and the terms of the model are read from the recording: they are the caller's.
"""

import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.evaluation.stress.cases import stress_scenario
from fotsmc_pin.files import markdown_table

REPEATS = 10
NUMBERS = (7, 7, 7, 7, 7, 49, 7, 490)
"""Of q, v, q_d, v_d, a_d, M, h and the regressor in a row."""

TIMER = r"""
#define _GNU_SOURCE
#include "fotsmc_panda.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}
static fotsmc_panda_state controller;
int main(int argc, char **argv) {
    const long ticks = atol(argv[2]);
    double *rows = malloc((size_t)ticks * 581 * sizeof(double));
    double *least = malloc((size_t)ticks * sizeof(double));
    FILE *file = fopen(argv[1], "rb");
    if (argc != 3 || fread(rows, 581 * sizeof(double), (size_t)ticks, file) != (size_t)ticks) {
        return 1;
    }
    double tau[7];
    for (int again = 0; again < REPEATS; again++) {
        fotsmc_panda_init(&controller);
        for (long k = 0; k < ticks; k++) {
            const double *x = rows + 581 * k;
#ifdef LEARNS
            double q[7], v[7], a[7];
            if (fotsmc_panda_regressor_due(&controller, q, v, a)) {
                fotsmc_panda_give_regressor(&controller, x + 91);
            }
#endif
            const double start = now();
            const int status = fotsmc_panda_update(&controller, x, x + 7, x + 14, x + 21, x + 28,
                                                   x + 35, x + 84, FOTSMC_PANDA_DT, tau);
            const double took = now() - start;
            if (status) { return 2; }
            if (!again || took < least[k]) { least[k] = took; }
        }
    }
    const double start = now();
    for (int k = 0; k < 1000; k++) { now(); }
    const double clock = (now() - start) / 1001.0;
    printf("%zu\n", sizeof controller);
    for (long k = 0; k < ticks; k++) { printf("%.0f\n", least[k] - clock); }
    return 0;
}
"""


class Watched:
    """A controller that keeps what each of its ticks was given, and the regressor."""

    def __init__(self, law):
        self.law, self.dt, self.arm, self.rows = law, law.dt, law.arm, []
        self.bare = getattr(law, "controller", law)

    def __getattr__(self, name):
        return getattr(self.law, name)

    def update(self, *row, dt=None):
        tau = self.law.update(*row, dt)
        terms = self.bare._terms
        found = getattr(self.law, "_data", None)
        regressor = np.zeros(490) if found is None else found.jointTorqueRegressor
        parts = (*row, terms.M, terms.h - self._ahead(terms), regressor)
        self.rows.append(np.concatenate([np.ravel(part) for part in parts]))
        return tau

    def _ahead(self, terms):
        """Friction that C adds itself; it is in Python's `h`."""
        return terms.friction(self.bare.joints) if hasattr(terms, "friction") else 0.0


def measured(learns, seconds):
    """Return the size of program and state [kB] and the least time of each tick [ns]."""
    scenario = stress_scenario(fp.load_arm("panda"))
    law = fp.RobustFONFTSM(scenario.arm, 1e-3)
    watched = Watched(fp.ModelLearning(law) if learns else law)
    scenario.run(watched, seconds)
    with tempfile.TemporaryDirectory() as folder:
        _, source = fp.export_c(watched.law, folder)
        rows, timer, program = (Path(folder) / name for name in ("rows", "timer.c", "timer"))
        np.array(watched.rows).tofile(rows)
        timer.write_text(TIMER, encoding="utf-8")
        defined = [f"-DREPEATS={REPEATS}", *(["-DLEARNS"] if learns else [])]
        part = f"{folder}/law.o"
        subprocess.run(["gcc", "-std=c99", "-O2", "-c", source, "-o", part], check=True)
        command = ["gcc", "-std=c99", "-O2", *defined, timer, part, "-lm", "-o", program]
        subprocess.run(command, check=True)
        count = str(len(watched.rows))
        done = subprocess.run([program, rows, count], check=True, capture_output=True, text=True)
        sizes = subprocess.run(["size", part], check=True, capture_output=True, text=True)
    state, *times = (float(word) for word in done.stdout.split())
    text = int(sizes.stdout.splitlines()[1].split()[0])
    return text / 1e3, state / 1e3, np.array(times)


def main():
    warnings.simplefilter("ignore")
    seconds = float(sys.argv[1]) if sys.argv[1:] else 4.0
    cells = []
    for learns in (False, True):
        text, state, times = measured(learns, seconds)
        later = times[1000:]
        for tick in range(4) if learns else (None,):
            part = later if tick is None else later[tick::4]
            what = "law only" if tick is None else f"learning, tick {tick} of a window"
            numbers = (np.median(part), part.max(), text, state)
            cells.append(
                (what, *(f"{x:.0f}" for x in numbers[:2]), *(f"{x:.1f}" for x in numbers[2:]))
            )
    head = ("tick", "median [ns]", "largest [ns]", "program and tables [kB]", "state [kB]")
    print(markdown_table(head, cells, "lrrrr"))


if __name__ == "__main__":
    main()
