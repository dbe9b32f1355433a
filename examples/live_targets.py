"""A 50 Hz stream of targets with dropouts, followed by a Panda in MuJoCo within all its limits.

The thread that sends stands for a gamepad, a planner or a learned policy: it swings the target to
and fro, loses a fifth of what it sends, and falls silent for the last second.

    python examples/live_targets.py [ARM] [SECONDS]
"""

from __future__ import annotations

import sys
import threading
import time

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.realtime import MujocoRobot
from fotsmc_pin.references import LiveTarget, Sinusoid


def send(live: LiveTarget, start: np.ndarray, duration: float) -> None:
    """Send targets, 50 each second, of which a fifth is lost."""
    rng = np.random.default_rng(0)
    began = time.perf_counter()
    while (t := time.perf_counter() - began) < duration:
        if rng.uniform() > 0.2:
            live.set_q(live.arm.integrate(start, 0.2 * np.sin(1.5 * t + np.arange(live.arm.nv))))
        time.sleep(0.02)


def main(name: str = "panda", duration: float = 6.0) -> None:
    arm = fp.load_arm(name)
    true = fp.perturb(arm, mass_scale=1.1, friction=0.2, damping=0.2)
    start = Sinusoid.inside_limits(arm).center
    live = LiveTarget(arm, q0=start, timeout=0.3)
    controller = fp.Safeguard(
        fp.RobustFONFTSM(arm, dt=1e-3), watchdog=0.1, limits=fp.Limits(arm, delay=2)
    )
    errors: list[float] = []

    def note_error(t: float, q: np.ndarray, *_: object) -> None:
        errors.append(float(np.linalg.norm(arm.difference(live(t)[0], q))))

    sender = threading.Thread(target=send, args=(live, start, duration - 1.0), daemon=True)
    sender.start()
    print(f"{name} follows live targets for {duration:g} s; Ctrl-C stops safely.")
    robot = MujocoRobot(true, start)
    print(fp.run_realtime(controller, robot, live, duration, stop_time=0.0, observe=note_error))
    sender.join()
    late = errors[-200:]
    print(f"error while it holds: {1e3 * max(late):.3g} mrad; targets were stale: {live.is_stale}")


if __name__ == "__main__":
    words = [*sys.argv[1:], *("panda", "6")[len(sys.argv) - 1 :]]
    main(words[0], float(words[1]))
