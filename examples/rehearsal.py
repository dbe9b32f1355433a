"""The first motion of a robot, rehearsed: a guarded law on an arm with a robot's faults.

Encoders of 17 bits and no velocity sensor, a torque that acts a tick late and through a lag, ticks
that come early and late, links that are heavier than their file says, friction. The law is in a
`Safeguard`, as it has to be on the robot: it begins softly from where the arm is.
"""

from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import Chain, Encoder, TickDelay, TorqueLag

DT = 1e-3


def main(out: Path = Path("out/rehearsal"), duration: float = 10.0) -> fp.Recording:
    """Rehearse for `duration` [s], and make the page."""
    nominal = fp.load_arm("ur5", armature="rotors")
    true = fp.perturb(nominal, mass_scale=1.2, payload=1.0, friction=0.5, damping=0.5)
    reference = Sinusoid.inside_limits(nominal, fraction=0.6)
    guarded = fp.Safeguard(fp.RobustFONFTSM(nominal, dt=DT), soft_start=2.0, watchdog=0.01)
    rec = fp.simulate(
        true,
        guarded,
        reference,
        duration,
        q0=nominal.integrate(reference(0.0)[0], np.full(nominal.nv, 0.2)),
        v0=np.zeros(nominal.nv),
        sensor=Encoder(nominal, DT, bits=17),
        actuator=Chain(TickDelay(1), TorqueLag(bandwidth=600.0, dt=DT)),
        jitter=0.2,
        integrator="semi-implicit",
    )
    summary = fp.summarize(rec)
    fastest = (np.abs(rec.v) / nominal.velocity_limit).max()
    print(f"error over the last half: {1e3 * summary.tail_rms_error:.2f} mrad RMS")
    print(f"largest torque {summary.peak_torque:.0f} N·m, {100 * fastest:.0f} % of a speed limit")
    print("stopped:", guarded.stopped)
    rec.save(out / "run.npz")  # To lay beside the robot's own recording.
    page = fp.export_html(rec, out / "rehearsal.html", title="A UR5's first motion, rehearsed")
    print(f"Open {page} in a browser.")
    return rec


if __name__ == "__main__":
    main()
