"""Identify an arm: from the log of one motion to a URDF that a controller can trust.

Writes the recording, `identified.urdf`, a page with the motion and one with every parameter into
`out/identify_arm`.
"""

from pathlib import Path

import fotsmc_pin as fp
from fotsmc_pin.simulation import Chain, Encoder, TorqueSensor
from fotsmc_pin.types import Reference
from fotsmc_pin.view import write_identification

DT = 1e-3


def main(out: Path = Path("out/identify_arm"), duration: float = 10.0) -> fp.Identification:
    """Record a hidden arm, identify it, and run the same law with the new model."""
    nominal = fp.load_arm("two_link")
    hidden = fp.perturb(  # What nobody knows: the real arm.
        nominal,
        mass_scale=fp.Uniform(0.7, 1.4),
        com_shift=0.02,
        payload=2.0,
        friction=1.0,
        damping=2.0,
        armature=0.5,
        seed=3,
    )

    excitation = fp.references.Excitation(nominal, period=5.0, repetitions=2)
    log = record(nominal, hidden, excitation, duration)
    other = record(nominal, hidden, fp.references.Sinusoid.inside_limits(nominal), 6.0)

    result = fp.identify(log, nominal, validate=other)
    print(result)
    for joint, kind in ((0, "friction"), (1, "damping"), (1, "armature")):
        row = result.group(kind)[joint]
        print(f"{kind} of {row.of}: {row.value:.3g} ± {row.deviation:.2g} {row.unit}")

    for name, arm in (("nominal", nominal), ("identified", result.arm)):
        rec = record(arm, hidden, fp.references.Sinusoid.inside_limits(nominal), 6.0)
        error = 1e3 * fp.summarize(rec).tail_rms_error
        print(f"tracking error with the {name} arm: {error:.3g} mrad RMS")

    out.mkdir(parents=True, exist_ok=True)
    log.save(out / "run.npz")
    fp.export_html(log, out / "motion.html", title="A motion that shows an arm's parameters")
    result.write_urdf(out / "identified.urdf")
    page = write_identification(result, out / "identified.html")
    print(f"Open {page} in a browser.")
    return result


def record(model: fp.Arm, hidden: fp.Arm, reference: Reference, duration: float) -> fp.Recording:
    """Run a law that knows `model` on the hidden arm, and keep what its sensors read."""
    return fp.simulate(
        hidden,
        fp.ComputedTorque(model, dt=DT),
        reference,
        duration,
        sensor=Chain(Encoder(hidden, DT, bits=20), TorqueSensor(hidden, noise=0.5)),
        integrator="semi-implicit",
    )


if __name__ == "__main__":
    main()
