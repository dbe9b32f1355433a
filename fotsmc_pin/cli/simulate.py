"""`fotsmc simulate`: one run of a controller on an arm, with its figures, metrics and page."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.cli.output import Force, plain_console, result_folder
from fotsmc_pin.errors import ArgumentError, DivergenceError

if TYPE_CHECKING:
    from fotsmc_pin.analysis import Summary


def simulate(
    arm: Annotated[str, typer.Argument(help="A URDF file, or a name that `fotsmc arms` lists.")],
    out: Annotated[Path | None, typer.Option(help="Folder for the results.")] = None,
    controller: Annotated[str, typer.Option(help="Name of the control law.")] = "AdaptiveFONFTSM",
    preset: Annotated[str | None, typer.Option(help="Set of gains; see the law's page.")] = None,
    gain: Annotated[
        list[str] | None, typer.Option(help="A single gain, as name=number or name=word.")
    ] = None,
    mass_scale: Annotated[float, typer.Option(help="Scale of all the true masses.")] = 1.0,
    payload: Annotated[float, typer.Option(help="Mass at the true tool frame [kg].")] = 0.0,
    start_error: Annotated[float, typer.Option(help="Start error of each joint [rad].")] = 0.0,
    duration: Annotated[float, typer.Option(help="Simulated time [s].")] = 10.0,
    dt: Annotated[float, typer.Option(help="Period of a tick [s].")] = 1e-3,
    substeps: Annotated[int, typer.Option(help="RK4 steps in a tick.")] = 1,
    package_dir: Annotated[
        list[Path] | None, typer.Option(help="Where package:// begins; may be repeated.")
    ] = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page when done.")] = False,
    force: Force = False,
) -> None:
    """Simulate a controller on an arm that differs from what the controller believes."""
    from fotsmc_pin import load_arm, perturb, plot
    from fotsmc_pin import simulate as run
    from fotsmc_pin.analysis import summarize
    from fotsmc_pin.checks import choice
    from fotsmc_pin.control import CONTROLLERS
    from fotsmc_pin.files import write_json
    from fotsmc_pin.references import Sinusoid
    from fotsmc_pin.view import export_html

    law = CONTROLLERS[choice("--controller", controller, [*CONTROLLERS])]
    nominal = load_arm(arm, package_dirs=[str(folder) for folder in package_dir or ()])
    true = perturb(nominal, mass_scale=mass_scale, payload=payload)
    if preset is None:
        preset = "practical" if "practical" in law.presets else next(iter(law.presets))
    ctl = law(nominal, dt, preset=preset, **_gains(gain or []))
    reference = Sinusoid.inside_limits(nominal)
    q_start, _, _ = reference(0.0)
    folder = result_folder(out or Path("out") / nominal.name, force=force)
    try:
        rec = run(
            true,
            ctl,
            reference,
            duration,
            q0=nominal.integrate(q_start, [start_error] * nominal.nv),
            substeps=substeps,
            progress=True,
        )
    except DivergenceError as error:
        error.recording.save(folder / "run.npz")
        raise
    rec.save(folder / "run.npz")
    summary = summarize(rec)
    write_json(folder / "metrics.json", summary.as_dict())
    plot(rec, folder / "run.png")
    page = folder / f"{nominal.name}.html"
    export_html(rec, page)
    console = plain_console()
    console.print(_table(nominal.name, summary))
    console.print(f"Open {page} in a browser; the run is kept in {folder / 'run.npz'}.")
    if open_page:
        webbrowser.open(page.resolve().as_uri())


def _gains(pairs: list[str]) -> dict[str, float | str | bool]:
    gains: dict[str, float | str | bool] = {}
    for pair in pairs:
        name, equals, value = pair.partition("=")
        if not equals:
            raise ArgumentError("--gain", pair, "write name=value")
        try:
            gains[name] = float(value)
        except ValueError:
            gains[name] = {"true": True, "false": False}.get(value.lower(), value)
    return gains


def _table(title: str, summary: Summary) -> object:
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    table.add_column("metric")
    table.add_column("value", justify="right")
    for name, value in (
        ("settling to 10 mrad [s]", f"{summary.settling_time:.3f}"),
        ("RMS error, last half [mrad]", f"{1e3 * summary.tail_rms_error:.4g}"),
        ("largest error, last half [mrad]", f"{1e3 * summary.max_tail_error:.4g}"),
        ("peak torque [N·m]", f"{summary.peak_torque:.4g}"),
        ("torque variation, last half [N·m/s]", f"{summary.tail_torque_variation:.4g}"),
        ("ticks at a limit [%]", f"{100 * summary.saturation_fraction:.3g}"),
    ):
        table.add_row(name, value)
    return table
