"""1 000 runs of a Panda that its controller misjudges: the distribution, and the worst case.

Each run is written to `study.sqlite` as soon as it is done. Stop the program at any time and start
it again: it goes on where it was.
"""

from pathlib import Path

import fotsmc_pin as fp
from fotsmc_pin.view import distribution_figure, save_figure


def main(
    out: Path = Path("out/study"), repeats: int = 500, duration: float = 3.0
) -> fp.StudyResult:
    """Run two controllers through the same `repeats` draws, `duration` [s] each."""
    out.mkdir(parents=True, exist_ok=True)
    run = fp.ClosedLoop(arm=fp.load_arm("panda"), duration=duration)
    controllers = ["RobustFONFTSM", "ComputedTorque"]
    result = fp.study(
        run,
        grid={"controller": controllers},
        draws={
            "mass_scale": fp.Uniform(0.8, 1.3),
            "payload": fp.Uniform(0.0, 2.0),
            "start_error": fp.Uniform(-0.1, 0.1),
        },
        repeats=repeats,
        seed=1,
        store=out / "study.sqlite",
        progress=True,
    )
    print(f"{len(result)} runs, {len(result.failed)} failed")

    groups = {name: result.where({"controller": name}) for name in controllers}
    for name, group in groups.items():
        median, worst = 1e3 * group.quantiles("tail_rms_error", (0.5, 1.0))
        print(f"{name}: median {median:.3g} mrad, worst {worst:.3g} mrad RMS in the last half")
    errors = {name: group.metric("tail_rms_error") for name, group in groups.items()}
    figure = distribution_figure(errors, "RMS error, last half", "mrad", scale=1e3)
    save_figure(figure, out / "distribution")

    # A run is its parameters and its seed: the worst one can be had again, as a whole.
    worst_run = groups[controllers[0]].worst("tail_rms_error")
    print(f"the worst case of {controllers[0]}: {dict(worst_run.parameters)}")
    rec = run.record(worst_run.parameters, worst_run.seed)
    fp.plot(rec, out / "worst")
    fp.export_html(rec, out / "worst.html", title="The worst run of the study")
    return result


if __name__ == "__main__":
    main()
