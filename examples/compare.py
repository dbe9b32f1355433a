"""Several controllers on one arm, in one figure, one page and one report.

Every one of them believes the UR5 as its URDF has it; the arm that moves is 30 % heavier, carries
3 kg and has friction.
"""

from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.files import write_json
from fotsmc_pin.view import write_report

DT = 1e-3


def main(out: Path = Path("out/compare"), duration: float = 8.0) -> dict[str, fp.Recording]:
    """Run four laws against the same arm for `duration` [s] and write the report."""
    nominal = fp.load_arm("ur5")
    true = fp.perturb(nominal, mass_scale=1.3, payload=3.0, friction=1.0)
    reference = fp.references.Sinusoid.inside_limits(nominal)
    q_start, _, _ = reference(0.0)
    q0 = nominal.integrate(q_start, np.full(nominal.nv, 0.1))

    laws: dict[str, fp.Controller] = {
        "PID": fp.ComputedTorque(nominal, DT, preset="pid"),
        "super-twisting": fp.SuperTwistingSMC(nominal, DT),
        "adaptive fractional": fp.AdaptiveFONFTSM(nominal, DT, preset="practical"),
        "robust fractional": fp.RobustFONFTSM(nominal, DT),
    }
    runs = {
        name: fp.simulate(true, law, reference, duration, q0=q0, integrator="semi-implicit")
        for name, law in laws.items()
    }

    summaries = {name: fp.summarize(rec) for name, rec in runs.items()}
    print(f"{'':20}{'settles [s]':>12}{'RMS [mrad]':>12}{'peak [N·m]':>12}{'[N·m/s]':>10}")
    for name, summary in summaries.items():
        print(
            f"{name:20}{summary.settling_time:12.2f}{1e3 * summary.tail_rms_error:12.3f}"
            f"{summary.peak_torque:12.1f}{summary.tail_torque_variation:10.0f}"
        )

    for name, rec in runs.items():
        rec.save(out / f"{name}.npz")
    metrics = {name: summary.as_dict() for name, summary in summaries.items()}
    write_json(out / "metrics.json", {"runs": metrics})
    fp.plot(runs, out / "comparison.svg")
    fp.export_html(runs, out / "compare.html", title="Four controllers on a heavier UR5")
    report = write_report(out, title="Four controllers on a heavier UR5")
    print(f"Open {report} in a browser.")
    return runs


if __name__ == "__main__":
    main()
