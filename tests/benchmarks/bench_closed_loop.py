"""`simulate` against the bare Pinocchio calls of the same ticks."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.references import Sinusoid
from tests.benchmarks.side_by_side import side_by_side

HEAD = ["10 s at 1 kHz, all recorded", "µs per tick", "× bare calls", "× own calls"]
SECONDS = 10.0
TICKS = 10_000
STAGES = {"rk4": 4, "semi-implicit": 1}


@pytest.mark.parametrize("name", ["two_link", "panda"])
@pytest.mark.parametrize("integrator", STAGES)
def test_closed_loop(name, integrator, table, benchmark):
    arm = fp.load_arm(name)
    controller = fp.AdaptiveFONFTSM(arm, 1e-3, preset="practical")
    reference = Sinusoid.inside_limits(arm)
    model, data, of_plant = arm.model, arm.model.createData(), arm.model.createData()
    q, v, tau = np.array(arm.neutral), np.zeros(arm.nv), np.zeros(arm.nv)
    stages = range(STAGES[integrator])

    def bare():
        for _ in range(TICKS):
            pin.crba(model, data, q)
            pin.computeCoriolisMatrix(model, data, q, v)
            pin.computeGeneralizedGravity(model, data, q)
            for _ in stages:
                pin.aba(model, of_plant, q, v, tau)

    def own():
        for _ in range(TICKS):
            pin.difference(model, q, q)
            pin.crba(model, data, q)
            pin.nonLinearEffects(model, data, q, v)
            for _ in stages:
                pin.aba(model, of_plant, q, v, tau)

    def loop():
        fp.simulate(arm, controller, reference, SECONDS, integrator=integrator)

    found = side_by_side({"bare": bare, "own": own, "loop": loop}, calls=1, rounds=15)
    row = [
        f"{arm.nv} joints, {integrator}",
        f"{1e6 * found.median('loop') / TICKS:.1f}",
        f"{found.ratio('loop', 'bare'):.2f}",
        f"{found.ratio('loop', 'own'):.2f}",
    ]
    table("A closed loop of AdaptiveFONFTSM", HEAD, row)
    benchmark.extra_info["ratio"] = found.ratio("loop", "bare")
    benchmark.pedantic(loop, rounds=1)
