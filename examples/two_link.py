"""The paper's two-link case through the library: its law, and the same without chattering.

`fotsmc reproduce` does more: every figure, every reading of the print, a verdict on each claim.
"""

from pathlib import Path

import fotsmc_pin as fp
from fotsmc_pin.paper import two_link


def main(
    out: Path = Path("out/two_link_example"), duration: float = two_link.DURATION
) -> dict[str, fp.Recording]:
    """Run the printed law, and the same law with a boundary layer, for `duration` [s]."""
    nominal, true = two_link.nominal_arm(), two_link.true_arm()
    print("masses the controller believes:", [body.mass for body in nominal.model.inertias[1:]])
    print("masses that move:              ", [body.mass for body in true.model.inertias[1:]])

    layer = {"switching": "saturation", "boundary_layer": 0.1}
    runs = {
        "sign, as printed": two_link.run(two_link.controller(), duration=duration),
        "boundary layer 0.1": two_link.run(two_link.controller(**layer), duration=duration),
    }
    for name, rec in runs.items():
        summary = fp.summarize(rec)
        print(
            f"{name}: settles at {summary.settling_time:.2f} s, "
            f"keeps {1e3 * summary.tail_rms_error:.2f} mrad RMS, "
            f"varies its torque by {summary.tail_torque_variation:.0f} N·m/s"
        )
        rec.save(out / f"{name}.npz")

    fp.plot(runs, out / "comparison.svg")
    fp.plot(runs["sign, as printed"], out / "tracking.svg", kind="tracking")
    fp.export_html(runs, out / "two_link.html", title="The paper's two-link case")
    print(f"Open {out / 'two_link.html'} in a browser.")
    return runs


if __name__ == "__main__":
    main()
