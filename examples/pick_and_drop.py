"""A Panda picks up 2 kg and drops them again; its controller learns what it carries, or does not.

Both controllers believe in the same URDF. The arm has friction and rotors that the file does not
state, so there is something to learn before the payload comes.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.learning import recorded_estimates
from fotsmc_pin.simulation import TickDelay

PICKED, DROPPED = 3.0, 6.0


def main(out: Path = Path("out/pick_and_drop"), duration: float = 9.0) -> dict[str, fp.Recording]:
    """Run `RobustFONFTSM` with and without learning for `duration` [s]."""
    nominal = fp.load_arm("panda")
    true = fp.perturb(
        nominal,
        mass_scale=1.1,
        friction=0.5,
        damping=0.5,
        armature=nominal.effort_limit / 200,
        name="true panda",
    )
    changes = {PICKED: fp.perturb(true, payload=2.0), DROPPED: true}
    reference = fp.references.Sinusoid.inside_limits(nominal, fraction=0.7)
    plain = fp.RobustFONFTSM(nominal, dt=1e-3)
    learning = fp.ModelLearning(fp.RobustFONFTSM(nominal, dt=1e-3), delay=1)

    def run(controller: fp.RobustFONFTSM | fp.ModelLearning) -> fp.Recording:
        events = {time: arm for time, arm in changes.items() if time < duration}
        return fp.simulate(
            true, controller, reference, duration, events=events, actuator=TickDelay(1)
        )

    runs = {"without learning": run(plain), "with learning": run(learning)}
    ends = [0.0, *(time for time in changes if time < duration), duration]
    for start, end in pairwise(ends):
        print(f"in the last second before {end:g} s:")
        for name, rec in runs.items():
            span = (rec.t > max(end - 1.0, start)) & (rec.t <= end)
            rms = 1e3 * np.sqrt(np.mean(rec.error_norm[span] ** 2))
            print(f"  {name}: {rms:.3f} mrad RMS")
        known = recorded_estimates(runs["with learning"], end - 1e-9)
        mass = known.group("payload")[0] if known else None
        if mass:
            print(f"  the payload is taken to be {mass.value:.2f} ± {mass.deviation:.2f} kg")

    for name, rec in runs.items():
        rec.save(out / f"{name}.npz")
    learning.learned_arm().write_urdf(out / "learned.urdf")
    print(f"The learnt arm is in {out / 'learned.urdf'}.")
    fp.plot(runs, out / "comparison.svg")
    fp.plot(runs["with learning"], out / "estimates.svg", kind="estimates")
    fp.export_html(
        runs["with learning"],
        out / "pick_and_drop.html",
        title="A Panda picks up 2 kg and drops them",
        signals=["payload"],
    )
    print(f"Open {out / 'pick_and_drop.html'} in a browser.")
    return runs


if __name__ == "__main__":
    main()
