"""A controller as C: export it, keep a recording, and let a C program repeat every torque.

Compile and run what this writes:

    gcc -std=c99 -O2 made/fotsmc_panda.c replay.c -Imade -lm -o replay && ./replay made/ticks.txt
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pinocchio as pin

import fotsmc_pin as fp
from fotsmc_pin.references import Sinusoid


class Watched:
    """A controller that writes down what each of its ticks is given and gives."""

    def __init__(self, law: fp.Controller) -> None:
        self.law, self.dt = law, law.dt
        self.rows: list[np.ndarray] = []

    def update(self, q, v, q_d, v_d, a_d, dt=None):  # type: ignore[no-untyped-def]
        """Call the law, and keep the tick."""
        tau = self.law.update(q, v, q_d, v_d, a_d, dt)
        model, data = self.law.arm.model, self.law.arm.model.createData()
        M, h = pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, v)
        period = self.dt if dt is None else dt
        parts = (q, v, q_d, v_d, a_d, M, h, period, tau)
        self.rows.append(np.concatenate([np.ravel(part) for part in parts]))
        return tau

    def reset(self) -> None:
        """Forget everything."""
        self.law.reset()
        self.rows.clear()

    @property
    def signals(self) -> dict[str, np.ndarray]:
        """What the law shows of itself."""
        return self.law.signals


def main(out: Path = Path("made"), duration: float = 5.0) -> None:
    """Export the robust law for a Panda, and record a run of it."""
    arm = fp.load_arm("panda")
    law = fp.RobustFONFTSM(arm, dt=1e-3)
    fp.export_c(law, out)
    watched = Watched(law)
    true = fp.perturb(arm, mass_scale=1.3, payload=1.0)
    fp.simulate(true, watched, Sinusoid.inside_limits(arm), duration)
    np.savetxt(out / "ticks.txt", watched.rows, fmt="%.17g")
    print(f"{out}/: the controller as C, and {len(watched.rows)} ticks to repeat")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if sys.argv[1:] else Path("made"))
