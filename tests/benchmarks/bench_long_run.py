"""An hour at 1 kHz with one row a second: memory and time per tick stay what they were."""

from __future__ import annotations

import resource
import time
from pathlib import Path

import numpy as np
import pinocchio as pin

import fotsmc_pin as fp

HEAD = ["3.6 million ticks, a row each second", "value"]
HOUR, MINUTE = 3600.0, 60.0
BARE_CALLS = 50
STATM = Path("/proc/self/statm")


def resident_kilobytes():
    """What the process holds now, where the system says so; elsewhere the most it ever held."""
    if STATM.is_file():
        return int(STATM.read_text().split()[1]) * resource.getpagesize() / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def test_an_hour(table, benchmark):
    arm = fp.load_arm("two_link")
    controller = fp.AdaptiveFONFTSM(arm, 1e-3, preset="practical")
    reference = fp.references.Sinusoid.inside_limits(arm)
    fp.simulate(arm, controller, reference, MINUTE, record_every=1000)
    model, data = arm.model, arm.model.createData()
    q, v, tau = np.array(arm.neutral), np.zeros(arm.nv), np.zeros(arm.nv)
    marks = np.full((20_000, 4), np.nan)  # filled, so that it is no growth of its own
    filled = 0

    def mark(fraction):
        nonlocal filled
        resident = resident_kilobytes()
        before = time.process_time()
        for _ in range(BARE_CALLS):
            pin.aba(model, data, q, v, tau)
        marks[filled] = fraction * HOUR, before, time.process_time(), resident
        filled += 1

    def hour():
        return fp.simulate(arm, controller, reference, HOUR, record_every=1000, progress=mark)

    rec = benchmark.pedantic(hour, rounds=1)
    t, before, after, memory = marks[:filled].T
    # Each stretch of ticks is measured in bare calls made right after it: the machine drifts.
    ticking, calling = before[1:] - after[:-1], (after - before)[1:]
    per_tick = ticking / np.diff(t) * 1e-3
    in_first, in_last = t[1:] < MINUTE, t[1:] > HOUR - MINUTE
    first, last = (
        np.median(per_tick[part]) / np.median(calling[part]) * BARE_CALLS
        for part in (in_first, in_last)
    )
    recorded = sum(
        array.nbytes for array in (rec.t, rec.q, rec.v, rec.q_d, rec.v_d, rec.e, rec.e_dot, rec.tau)
    ) + sum(signal.nbytes for signal in rec.signals.values())
    table(
        "A long run",
        HEAD,
        ["a tick in the first minute [µs]", f"{1e6 * np.median(per_tick[in_first]):.2f}"],
        ["a tick in the last minute [µs]", f"{1e6 * np.median(per_tick[in_last]):.2f}"],
        ["a tick in the first minute [calls of aba then]", f"{first:.2f}"],
        ["a tick in the last minute [calls of aba then]", f"{last:.2f}"],
        ["last over first", f"{last / first:.3f}"],
        ["growth of the process's memory [kB]", f"{memory[-1] - memory[0]:.0f}"],
        ["size of the recording [kB]", f"{recorded / 1024:.0f}"],
    )
