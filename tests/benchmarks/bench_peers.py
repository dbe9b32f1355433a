"""Computed torque on the Panda at 1 kHz: this library, MuJoCo, Drake and Robotics Toolbox."""

from __future__ import annotations

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.references import Sinusoid
from tests.benchmarks import peers
from tests.benchmarks.side_by_side import side_by_side

HEAD = ["program", "µs per tick", "× this library, semi-implicit", "error at the end [mrad]"]
TICKS = 10_000
OURS = "this library, semi-implicit"


def test_peers(table, benchmark):
    # Joint friction would be solved for here and left out there: none anywhere.
    arm = fp.perturb(fp.load_arm("panda"), friction=0.0, damping=0.0, name="panda")
    reference = Sinusoid.inside_limits(arm)
    wanted = reference.at(peers.DT * np.arange(TICKS + 1))
    gains = {"kp": peers.KP, "kd": peers.KD}
    candidates, errors, missing = {}, {}, []
    for integrator in ("semi-implicit", "rk4"):
        name = f"this library, {integrator}"
        controller = fp.ComputedTorque(arm, peers.DT, **gains)
        candidates[name] = closed_loop(arm, controller, reference, integrator, errors, name)
    for name, make in {
        "MuJoCo, implicitfast, mj_inverse": lambda: peers.mujoco_tick(arm, wanted, "implicitfast"),
        "MuJoCo, RK4, mj_inverse": lambda: peers.mujoco_tick(arm, wanted, "rk4"),
        "Drake, discrete plant": lambda: peers.drake_tick(arm, wanted),
        "Robotics Toolbox, rne and accel": lambda: peers.toolbox_tick(arm, wanted),
    }.items():
        try:
            tick, errors[name] = make()
        except ImportError as error:
            missing.append([name, "not installed", f"({error})", ""])
        else:
            candidates[name] = repeated(tick)
    found = side_by_side(candidates, calls=1, rounds=5)
    rows = [
        [
            name,
            f"{1e6 * found.median(name) / TICKS:.1f}",
            f"{found.ratio(name, OURS):.2f}",
            f"{1e3 * np.linalg.norm(errors[name]()):.2g}",
        ]
        for name in candidates
    ]
    title = "Computed torque on the Panda, 1 kHz: reference, control, one step"
    table(title, HEAD, *rows, *missing)
    benchmark.pedantic(candidates[OURS], rounds=3)


def closed_loop(arm, controller, reference, integrator, errors, name):
    def run():
        duration = (TICKS - 1) * peers.DT
        rec = fp.simulate(arm, controller, reference, duration, integrator=integrator)
        errors[name] = lambda: rec.e[-1]

    return run


def repeated(tick):
    def run():
        for _ in range(TICKS):
            tick()

    return run
