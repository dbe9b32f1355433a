"""An hour at 1 kHz with one row a second: memory and time per tick stay what they were."""

from __future__ import annotations

import resource
import time

import numpy as np

import fotsmc_pin as fp

HEAD = ["3.6 million ticks, a row each second", "value"]
HOUR, MINUTE = 3600.0, 60.0


def test_an_hour(table, benchmark):
    arm = fp.load_arm("two_link")
    controller = fp.AdaptiveFONFTSM(arm, 1e-3, preset="practical")
    reference = fp.references.Sinusoid.inside_limits(arm)
    fp.simulate(arm, controller, reference, MINUTE, record_every=1000)
    marks = []

    def mark(fraction):
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        marks.append((fraction * HOUR, time.process_time(), peak))

    def hour():
        return fp.simulate(arm, controller, reference, HOUR, record_every=1000, progress=mark)

    rec = benchmark.pedantic(hour, rounds=1)
    t, spent, memory = np.array(marks).T
    per_tick = np.diff(spent) / np.diff(t) * 1e-3
    first, last = per_tick[t[1:] < MINUTE], per_tick[t[1:] > HOUR - MINUTE]
    recorded = sum(
        array.nbytes for array in (rec.t, rec.q, rec.v, rec.q_d, rec.v_d, rec.e, rec.ed, rec.tau)
    ) + sum(signal.nbytes for signal in rec.signals.values())
    table(
        "A long run",
        HEAD,
        ["time per tick in the first minute, median [µs]", f"{1e6 * np.median(first):.2f}"],
        ["time per tick in the last minute, median [µs]", f"{1e6 * np.median(last):.2f}"],
        ["last over first", f"{np.median(last) / np.median(first):.3f}"],
        ["growth of the process's memory [kB]", f"{memory[-1] - memory[0]:.0f}"],
        ["size of the recording [kB]", f"{recorded / 1024:.0f}"],
    )
