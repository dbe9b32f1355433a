"""A Panda carries 2 kg that its controller does not know of.

The payload is a steel ball at the tool frame, drawn in the page. The controller's URDF stays as it
is; the gravity, the inertia and the coupling of the ball are left to the law to overcome.
"""

from pathlib import Path

import numpy as np

import fotsmc_pin as fp


def main(out: Path = Path("out/panda_payload"), duration: float = 10.0) -> dict[str, fp.Recording]:
    """Run the same controller without and with the payload for `duration` [s]."""
    nominal = fp.load_arm("panda")
    print(f"the effort limits can hold {fp.inspect_arm(nominal).payload:.1f} kg everywhere")
    loaded = fp.perturb(nominal, payload=fp.Payload(mass=2.0), name="panda with 2 kg")

    reference = fp.references.Sinusoid.inside_limits(loaded, fraction=0.7)
    q_start, _, _ = reference(0.0)
    q0 = nominal.integrate(q_start, np.full(nominal.nv, 0.1))
    controller = fp.RobustFONFTSM(nominal, dt=1e-3)
    runs = {
        "empty hand": fp.simulate(nominal, controller, reference, duration, q0=q0),
        "2 kg": fp.simulate(loaded, controller, reference, duration, q0=q0),
    }
    for name, rec in runs.items():
        summary = fp.summarize(rec)
        print(
            f"{name}: settles at {summary.settling_time:.2f} s, "
            f"keeps {1e3 * summary.tail_rms_error:.2f} mrad RMS, "
            f"is at a torque limit {100 * summary.saturation_fraction:.1f} % of the time"
        )
        rec.save(out / f"{name}.npz")

    loaded.write_urdf(out / "panda_with_2kg.urdf")
    fp.plot(runs, out / "comparison.svg")
    fp.export_html(
        runs["2 kg"], out / "panda_payload.html", title="A Panda with 2 kg it does not know of"
    )
    print(f"Open {out / 'panda_payload.html'} in a browser.")
    return runs


if __name__ == "__main__":
    main()
