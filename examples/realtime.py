"""A controller at 1 kHz against a MuJoCo plant that runs in wall-clock time.

Copy this file to your robot: in place of `MujocoRobot` put a class of yours with the same `read`,
which returns `q` and `v`, and `write`, which takes the torque.

    python examples/realtime.py [ARM] [SECONDS]

Ctrl-C stops the arm safely: torque goes over to gravity compensation and damping.
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

    robot = MujocoRobot(true, start)
    # A desktop is late now and then: on a real-time system leave the watchdog at its ten ticks.
    controller = fp.Safeguard(fp.RobustFONFTSM(arm, dt=1e-3), soft_start=1.0, watchdog=0.1)
    squares: list[float] = []

    def note_error(t: float, q: NDArray[np.float64], *_: object) -> None:
        if 0.5 * duration < t < duration:
            squares.append(float(np.sum(arm.difference(reference(t)[0], q) ** 2)))

    print(f"{name} for {duration:g} s at 1 kHz; Ctrl-C stops safely.")
    print(fp.run_realtime(controller, robot, reference, duration, observe=note_error))
    if squares:
        print(f"RMS error over the last half: {1e3 * np.sqrt(np.mean(squares)):.3g} mrad")


if __name__ == "__main__":
    words = [*sys.argv[1:], *("panda", "5")[len(sys.argv) - 1 :]]
    main(words[0], float(words[1]))
