"""What limits cost in a tick of control, and what targets do that come while the arm moves.

    python -m tests.benchmarks -k limits

Times of the filter without distances are of one state, over and over, of calls of every candidate
in turn. With distances the ticks differ: a run under random torques is replayed, and of each tick
the least time of all replays counts, since what interrupts the program is not the filter's.
"""

from __future__ import annotations

import itertools
import os
import time

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.model_terms import ModelTerms
from fotsmc_pin.control.safety.limit_filter import LimitFilter
from fotsmc_pin.references import LiveTarget, Sinusoid, Spline
from tests.benchmarks.side_by_side import side_by_side
from tests.robust.adversarial import run

DT = 1e-3
CALLS, ROUNDS = 200, 150
REPLAYS, RUNS = 12, (5, 6, 7)
"""How often each run is replayed, and which of `tests.robust.adversarial`."""
HEAD = ["a tick of", "least [µs]", "median [µs]"]


def state(arm, share):
    """A state well inside the limits at a share of full speed, and the torque that keeps it."""
    low, high = arm.lower_position_limit, arm.upper_position_limit
    q = low + (high - low) * np.random.default_rng(1).uniform(0.4, 0.6, arm.nv)
    v = share * arm.velocity_limit
    return q, v, arm.inverse_dynamics(q, v, np.zeros(arm.nv))


def ticking(arm, share, *, is_shared):
    """A tick of the filter at a share of full speed."""
    guard, (q, v, tau) = LimitFilter(fp.Limits(arm), DT), state(arm, share)
    terms = ModelTerms(arm.model)
    pin.crba(arm.model, terms._data, q)
    pin.nonLinearEffects(arm.model, terms._data, q, v)
    given = terms if is_shared else None

    def tick():
        guard.take(q, v)
        return guard.torque(tau, None, given)

    assert (tick() == tau).all(), "the state is near a limit"
    return tick


def test_limits(table, benchmark):
    arm = fp.load_arm("panda")
    model, data = arm.model, arm.model.createData()
    q, v, _ = state(arm, 0.3)
    live, sinusoid = LiveTarget(arm), Sinusoid.inside_limits(arm)
    clock, targets = itertools.count(), itertools.count()
    samples = np.arange(0.0, 20.0, 0.1)
    spline = Spline.from_samples(arm, samples, [sinusoid(t)[0] for t in samples])

    def now():
        return DT * (next(clock) % 20000)

    def stream():
        k = next(targets)
        if k % 20 == 0:
            live.set_q(0.5 * q * (-1) ** (k // 400))
        return live(DT * k)

    def bare():
        pin.crba(model, data, q)
        pin.nonLinearEffects(model, data, q, v)

    candidates = {
        "crba + nonLinearEffects": bare,
        "limits, a law that shares its model": ticking(arm, 0.3, is_shared=True),
        "the same, a joint fast": ticking(arm, 0.7, is_shared=True),
        "limits, a law of its own": ticking(arm, 0.3, is_shared=False),
        "that, a joint fast": ticking(arm, 0.7, is_shared=False),
        "LiveTarget, a target at each 20th tick": stream,
        "Sinusoid": lambda: sinusoid(now()),
        "Spline": lambda: spline(now()),
    }
    found = side_by_side(candidates, calls=CALLS, rounds=ROUNDS)
    rows = [
        [name, f"{1e6 * min(found.rounds[name]):.2f}", f"{1e6 * found.median(name):.2f}"]
        for name in candidates
    ]
    load = f"{os.getloadavg()[0]:.1f}"
    table(f"Limits and references, {arm.nv} joints, at a load of {load}", HEAD, *rows)
    benchmark(candidates["the same, a joint fast"])


@pytest.mark.parametrize("name", ["panda", "ur5", "kinova"])
def test_limits_with_distances(name, table, benchmark):
    arm = fp.load_arm(name)
    guard, least = LimitFilter(fp.Limits(arm, clearance=0.03), DT), []
    for seed in RUNS:
        *_, rec = run(arm, seed, clearance=0.03, seconds=1.6)
        law, spent = rec.tau - rec.signals["limit_torque"], []
        for _ in range(REPLAYS):
            guard.reset()
            times = []
            for q, v, tau in zip(rec.q, rec.v, law, strict=True):
                started = time.perf_counter()
                guard.take(q, v)
                guard.torque(tau)
                times.append(time.perf_counter() - started)
            spent.append(times)
        least.extend(1e6 * np.min(spent, axis=0))
    cells = [f"{np.percentile(least, share):.0f}" for share in (50, 99, 100)]
    head = ["a tick with distances of", "median [µs]", "99th percentile [µs]", "longest [µs]"]
    table(
        f"Limits with distances, {len(least)} ticks, least of {REPLAYS} replays",
        head,
        [name, *cells],
    )
    benchmark.extra_info["p99"] = float(np.percentile(least, 99))
    benchmark.pedantic(lambda: guard.take(rec.q[0], rec.v[0]), rounds=1)
