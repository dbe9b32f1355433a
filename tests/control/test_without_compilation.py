"""The compiled kernels compute what their Python source says."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import FONFTSM, SuperTwistingSMC
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import simulate

ROOT = Path(__file__).parents[2]
CASES = {"FONFTSM": (FONFTSM, "practical"), "SuperTwistingSMC": (SuperTwistingSMC, "sign")}


def torques():
    """Torques of short runs in closed loop, (law, ticks, nv)."""
    arm = load_arm("two_link")
    reference = Sinusoid.inside_limits(arm)
    start = arm.integrate(reference(0.0)[0], [0.1, -0.1])
    runs = [
        simulate(arm, law(arm, 1e-3, preset=preset), reference, 0.05, q0=start).tau
        for law, preset in CASES.values()
    ]
    return np.array(runs)


def test_plain_python_gives_the_same_torques(tmp_path):
    file = tmp_path / "torques.npy"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, __file__, str(file)], check=True, env=environment, cwd=tmp_path)
    np.testing.assert_allclose(torques(), np.load(file), rtol=1e-9, atol=1e-9)


if __name__ == "__main__":
    np.save(sys.argv[1], torques())
