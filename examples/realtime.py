"""A controller at 1 kHz against a MuJoCo plant that runs in wall-clock time.

Copy this file to your robot: in place of `MujocoRobot` put a class of yours with the same `read`,
which returns `q` and `v`, and `write`, which takes the torque. It must declare `compensates`, what
its drives add to a torque, and `paced`, whether its `read` waits for the next tick.

    python examples/realtime.py [ARM] [SECONDS]

Ctrl-C stops the arm safely: it brakes, and is held where it comes to rest.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.realtime import MujocoRobot
from fotsmc_pin.references import Sinusoid

if TYPE_CHECKING:
    from numpy.typing import NDArray


def main(name: str = "panda", duration: float = 5.0) -> None:
    # What the controller believes, and what it meets: heavier links, friction, another start.
    arm = fp.load_arm(name)
    true = fp.perturb(arm, mass_scale=1.2, friction=0.3, damping=0.3)
    reference = Sinusoid.inside_limits(arm)
    start = arm.integrate(reference(0.0)[0], np.full(arm.nv, 0.1))

    # As most arms with a torque interface: the drives add gravity, by their own model.
    robot = MujocoRobot(true, start, compensates=("gravity",), believed=arm)
    # A desktop is late now and then: on a real-time system leave the watchdog at its ten ticks.
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, dt=1e-3), soft_start=1.0, watchdog=0.1)

    print(f"{name} for {duration:g} s at 1 kHz; Ctrl-C stops safely.")
    run = fp.run_realtime(controller, robot, reference, duration)
    print(run)
    rec = run.recording
    late = (rec.t > 0.5 * duration) & (rec.t < duration)
    if late.any():
        print(f"RMS error over the last half: {1e3 * rms(rec.error_norm[late]):.3g} mrad")


def rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


if __name__ == "__main__":
    words = [*sys.argv[1:], *("panda", "5")[len(sys.argv) - 1 :]]
    main(words[0], float(words[1]))
