"""A tick of control against the bare Pinocchio calls that it stands on."""

from __future__ import annotations

import warnings

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS, PaperConditionWarning
from fotsmc_pin.references import Sinusoid
from tests.benchmarks.side_by_side import side_by_side

HEAD = ["tick of", "µs", "× M0, C0, G0", "× own calls"]
PLAIN, OWN = "crba + computeCoriolisMatrix + computeGeneralizedGravity", "crba + nonLinearEffects"


@pytest.mark.parametrize("name", ["two_link", "panda"])
def test_ticks(name, table, benchmark):
    arm = fp.load_arm(name)
    reference = Sinusoid.inside_limits(arm)
    q_d, v_d, a_d = reference(1.234)
    q, v = arm.integrate(q_d, np.full(arm.nv, 0.01)), v_d + 0.01
    model, data = arm.model, arm.model.createData()

    def plain():
        pin.crba(model, data, q)
        pin.computeCoriolisMatrix(model, data, q, v)
        pin.computeGeneralizedGravity(model, data, q)

    def own():
        pin.crba(model, data, q)
        pin.nonLinearEffects(model, data, q, v)

    candidates = {PLAIN: plain, OWN: own, "the reference": lambda: reference(1.234)}
    for law, controller in controllers(arm).items():
        candidates[law] = lambda update=controller.update: update(q, v, q_d, v_d, a_d)
    found = side_by_side(candidates, calls=100, rounds=150)
    rows = [
        [
            candidate,
            f"{1e6 * found.median(candidate):.2f}",
            f"{found.ratio(candidate, PLAIN):.2f}",
            f"{found.ratio(candidate, OWN):.2f}",
        ]
        for candidate in candidates
    ]
    table(f"A tick of control, {arm.nv} joints", HEAD, *rows)
    benchmark.extra_info["ratio"] = found.ratio("AdaptiveFONFTSM", PLAIN)
    benchmark(candidates["AdaptiveFONFTSM"])


def controllers(arm):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PaperConditionWarning)
        return {
            name: law(arm, 1e-3, preset="practical" if "practical" in law.presets else None)
            for name, law in CONTROLLERS.items()
        }
