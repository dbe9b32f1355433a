"""A closed loop on an arm with joint friction, in motion and at rest, against its bare calls."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.references import Hold, Sinusoid
from tests.benchmarks.side_by_side import side_by_side

HEAD = ["7 joints with friction, 5 s at 1 kHz", "µs per tick", "× bare calls", "plant alone, µs"]
SECONDS = 5.0
TICKS = 5_000


class Still:
    """A law that costs nothing: it holds the torque that it was given."""

    dt = 1e-3

    def __init__(self, tau):
        self.tau = tau

    def update(self, q, v, q_d, v_d, a_d):
        return self.tau

    def reset(self):
        pass


@pytest.mark.parametrize("state", ["motion", "rest"])
def test_loop_with_friction(state, table, benchmark):
    arm = fp.perturb(fp.load_arm("panda"), friction=0.5, damping=0.5)
    controller = fp.AdaptiveFONFTSM(arm, 1e-3, preset="practical")
    reference = Sinusoid.inside_limits(arm) if state == "motion" else Hold(arm)
    q_start, _, _ = reference(0.0)
    pushed = Still(arm.gravity(q_start) + (1.0 if state == "motion" else 0.0))
    model, data, of_plant = arm.model, arm.model.createData(), arm.model.createData()
    q, v, tau = np.array(arm.neutral), np.zeros(arm.nv), np.zeros(arm.nv)

    def bare():
        for _ in range(TICKS):
            pin.crba(model, data, q)
            pin.computeCoriolisMatrix(model, data, q, v)
            pin.computeGeneralizedGravity(model, data, q)
            pin.aba(model, of_plant, q, v, tau)

    def loop():
        return fp.simulate(arm, controller, reference, SECONDS, integrator="semi-implicit")

    def plant():
        return fp.simulate(arm, pushed, reference, SECONDS, integrator="semi-implicit")

    resting = np.mean(loop().v == 0.0)
    assert (resting > 0.5) == (state == "rest"), "the state is the one that is measured"
    found = side_by_side({"bare": bare, "loop": loop, "plant": plant}, calls=1, rounds=9)
    row = [
        state,
        f"{1e6 * found.median('loop') / TICKS:.1f}",
        f"{found.ratio('loop', 'bare'):.2f}",
        f"{1e6 * found.median('plant') / TICKS:.1f}",
    ]
    table("A closed loop with joint friction, semi-implicit", HEAD, row)
    benchmark.extra_info["ratio"] = found.ratio("loop", "bare")
    benchmark.pedantic(loop, rounds=1)
