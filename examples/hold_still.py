"""A Panda holds one pose for 12 s, and is pushed at the hand; two laws bring it back to rest.

Dry friction is what makes this hard: integral action winds up while a joint sticks, and breaks it
loose beyond its goal. The links are heavier than both laws believe, and 3 kg hang at the tool.
"""

from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import TickDelay

POSE = [0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8]
PUSH = fp.Wrench(start=4.0, duration=1.5, force=[0.0, 40.0, 0.0], rise=0.1)


def main(out: Path = Path("out/hold_still"), duration: float = 12.0) -> dict[str, fp.Recording]:
    """Hold with two laws, on an arm that neither knows, for `duration` [s]."""
    nominal = fp.load_arm("panda", armature="rotors")
    true = fp.perturb(nominal, mass_scale=1.3, payload=3.0, friction=1.0, damping=0.5)
    push = PUSH if duration > PUSH.end else None
    q0 = nominal.integrate(np.array(POSE), np.full(nominal.nv, 0.1))  # 0.1 rad off.

    laws: dict[str, fp.Controller] = {
        "robust": fp.RobustFONFTSM(nominal, dt=1e-3),
        "PID": fp.ComputedTorque(nominal, dt=1e-3, preset="pid"),
    }
    runs = {}
    for name, law in laws.items():
        rec = runs[name] = fp.simulate(
            true,
            law,
            Hold(nominal, POSE),
            duration,
            q0=q0,
            disturbance=push,
            actuator=TickDelay(1),
            integrator="semi-implicit",
            substeps=2,
        )
        late = rec.t > 0.75 * duration
        swing = np.ptp(rec.e[late], axis=0).max()
        error = np.abs(rec.e[late]).max()
        print(
            f"{name:7} last quarter: off by {1e3 * error:.3f} mrad, swings {1e3 * swing:.3f} mrad"
        )

    fp.plot(runs, out / "comparison.svg")
    page = fp.export_html(
        runs,
        out / "hold_still.html",
        title="A Panda holds still, and is pushed",
        layout="side by side",
    )
    print(f"Open {page} in a browser.")
    return runs


if __name__ == "__main__":
    main()
