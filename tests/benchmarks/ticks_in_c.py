"""Time of a tick in C at seven joints, its worst of many, and the figure of both.

`python -m tests.benchmarks.ticks_in_c [TICKS]` exports the laws for a Panda, compiles them with
`gcc -O2`, lets them track at 1 kHz of their own time as fast as they can, and prints the least and
the median over batches, the slowest single tick, and how often
the operating system gave the processor to somebody else.
"""

import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import matplotlib as mpl

import fotsmc_pin as fp
from fotsmc_pin.files import markdown_table

mpl.use("Agg")
from matplotlib import pyplot as plt

TICKS = 10_000_000
BOUNDS = {"AdaptiveFONFTSM": 1200.0, "RobustFONFTSM": 1500.0}
OUT = Path("test-output/ticks_in_c.svg")

TIMER = r"""
#define _GNU_SOURCE
#include "fotsmc_panda.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>

enum { BATCH = 200, BINS = 400 };
static long long now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1000000000LL * t.tv_sec + t.tv_nsec;
}
static long preemptions(void) {
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    return used.ru_nivcsw;
}
static int rising(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}
static fotsmc_panda_state controller;
static double q[7], v[7], q_d[7], v_d[7], a_d[7], M[49], h[7], tau[7];
static double phase;
static void tick(void) {
    /* A slow sine is followed with an error that wanders. */
    phase += 1e-3;
    const double s = sin(phase), c = cos(phase);
    for (int i = 0; i < 7; i++) {
        q_d[i] = 0.3 * s; v_d[i] = 0.3 * c; a_d[i] = -0.3 * s;
        q[i] = q_d[i] + 1e-3 * c * (i + 1); v[i] = v_d[i] - 1e-3 * s * (i + 1);
    }
}
int main(int argc, char **argv) {
    const long ticks = argc > 1 ? atol(argv[1]) : 1000000L;
    fotsmc_panda_init(&controller);
    for (int i = 0; i < 7; i++) { M[8 * i] = 1.0 - 0.12 * i; h[i] = 2.0 - 0.2 * i; }
    const long batches = ticks / BATCH;
    double *times = malloc((size_t)batches * sizeof(double));
    if (times == NULL) { return 1; }
    long long worst = 0, without = 0;
    const long forced = preemptions();
    long interrupted = 0;
    for (long b = 0; b < batches; b++) {
        long long spent = 0;
        for (int k = 0; k < BATCH; k++) {
            tick();
            const long long start = now();
            fotsmc_panda_update(&controller, q, v, q_d, v_d, a_d, M, h, FOTSMC_PANDA_DT, tau);
            const long long took = now() - start;
            spent += took;
            if (took > worst) { worst = took; }
            if (took > 5000) { interrupted++; } else if (took > without) { without = took; }
        }
        times[b] = (double)spent / BATCH;
    }
    qsort(times, (size_t)batches, sizeof(double), rising);
    const long long a = now();
    long long b = a;
    for (int k = 0; k < 1000; k++) { b = now(); }
    const double clock = (double)(b - a) / 1000.0;
    printf("%.1f %.1f %.1f %lld %ld %lld %ld\n", times[0], times[batches / 2], clock, worst,
           interrupted, without, preemptions() - forced);
    free(times);
    return 0;
}
"""


def measured(law, ticks):
    """Return the numbers that the timer prints."""
    with tempfile.TemporaryDirectory() as folder:
        fp.export_c(law(fp.load_arm("panda"), 1e-3, preset=[*law.presets][-1]), folder)
        timer, program = Path(folder) / "timer.c", Path(folder) / "timer"
        timer.write_text(TIMER, encoding="utf-8")
        source = Path(folder) / "fotsmc_panda.c"
        command = ["gcc", "-std=c99", "-O2", str(timer), str(source), "-lm", "-o", str(program)]
        subprocess.run(command, check=True)
        shown = subprocess.run([program, str(ticks)], check=True, capture_output=True, text=True)
    return [float(word) for word in shown.stdout.split()]


def draw(rows):
    """Draw the least and the median time of each law beside its bound."""
    figure, axes = plt.subplots(figsize=(6.0, 2.2), layout="constrained")
    for place, (name, (least, median, clock, *_)) in enumerate(rows.items()):
        axes.barh(
            place, (median - clock) / 1e3, color="#9ecae1", label="median" if not place else ""
        )
        axes.barh(place, (least - clock) / 1e3, color="#3182bd", label="least" if not place else "")
        bound = BOUNDS[name] / 1e3
        axes.plot(
            [bound, bound], [place - 0.4, place + 0.4], "k--", label="bound" if not place else ""
        )
    axes.set_yticks(range(len(rows)), list(rows))
    axes.set_xlabel("time of a tick at seven joints, law only [µs]")
    axes.legend(fontsize="small", frameon=False)
    OUT.parent.mkdir(exist_ok=True)
    figure.savefig(OUT, metadata={"Date": None})
    plt.close(figure)


def main():
    warnings.simplefilter("ignore")
    ticks = int(sys.argv[1]) if sys.argv[1:] else TICKS
    rows = {name: measured(getattr(fp, name), ticks) for name in BOUNDS}
    head = (
        "law",
        "least [ns]",
        "median [ns]",
        "bound [ns]",
        "worst [µs]",
        "above 5 µs",
        "worst of the others [µs]",
        "preemptions",
    )
    cells = [
        (
            name,
            f"{least - clock:.0f}",
            f"{median - clock:.0f}",
            f"{BOUNDS[name]:.0f}",
            f"{worst / 1e3:.0f}",
            f"{slow:.0f}",
            f"{rest / 1e3:.1f}",
            f"{forced:.0f}",
        )
        for name, (least, median, clock, worst, slow, rest, forced) in rows.items()
    ]
    print(markdown_table(head, cells, "lrrrrrrr"))
    draw(rows)


if __name__ == "__main__":
    main()
