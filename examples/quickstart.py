"""The first run: a controller that believes one URDF moves an arm that is another.

Writes `run.npz`, a figure and a page with the moving arm into `out/quickstart`.
"""

from pathlib import Path

import numpy as np

import fotsmc_pin as fp


def main(out: Path = Path("out/quickstart"), duration: float = 8.0) -> fp.Recording:
    """Simulate the two-link arm with wrong masses, friction and a disturbance."""
    nominal = fp.load_arm("two_link")  # What the controller believes.
    true = fp.perturb(nominal, mass_scale=1.3, payload=0.5, friction=0.5)  # What moves.

    controller = fp.AdaptiveFONFTSM(nominal, dt=1e-3, preset="practical")
    reference = fp.references.Sinusoid.inside_limits(nominal, amplitude=0.8)

    def disturbance(t: float) -> np.ndarray:
        return np.array([2.0 * np.sin(t), np.cos(2.0 * t)])

    q_start, _, _ = reference(0.0)
    rec = fp.simulate(
        true,
        controller,
        reference,
        duration,
        q0=nominal.integrate(q_start, [0.3, -0.3]),  # 0.3 rad off in each joint.
        disturbance=disturbance,
        progress=True,
    )

    summary = fp.summarize(rec)
    print(f"below 10 mrad for good after {summary.settling_time:.2f} s")
    print(f"error over the last half: {1e3 * summary.tail_rms_error:.2f} mrad RMS")
    print(f"largest torque: {summary.peak_torque:.0f} N·m")

    rec.save(out / "run.npz")
    fp.plot(rec, out / "run.svg")
    fp.export_html(rec, out / "run.html", title="Two-link arm, masses +30 %")
    print(f"Open {out / 'run.html'} in a browser.")
    return rec


if __name__ == "__main__":
    main()
