"""`fotsmc simulate`: one run of a controller on an arm, with its figures, metrics and page."""

from __future__ import annotations

import webbrowser
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.law_options import PANEL as LAW_PANEL
from fotsmc_pin.cli.law_options import LawOptions
from fotsmc_pin.cli.output import (
    INTERRUPTED,
    Force,
    file_name,
    result_folder,
    say,
    say_error,
)
from fotsmc_pin.cli.plant_options import PlantOptions
from fotsmc_pin.cli.run_references import complete_reference
from fotsmc_pin.cli.run_tasks import complete_task
from fotsmc_pin.cli.sensor_options import SensorOptions
from fotsmc_pin.errors import ArgumentError, DivergenceError, RunInterrupted

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Actuator


@with_groups
def simulate(
    arm: ArmName,
    *,
    arm_options: ArmOptions,
    law: LawOptions,
    learn: Annotated[
        bool,
        typer.Option(
            "--learn",
            help="Let the law learn its model while the arm moves, and keep what was learnt as "
            "estimates.md, estimates.json and learned.urdf. --delay is known to it.",
            rich_help_panel=LAW_PANEL,
        ),
    ] = False,
    true: Annotated[
        str | None,
        typer.Option(
            "--true",
            help="URDF of the true arm, the plant; by default the nominal one.",
            rich_help_panel="How the true arm differs",
        ),
    ] = None,
    plant: PlantOptions,
    reference: Annotated[
        str,
        typer.Option(
            help="sine, move (point to point, then rest), hold, paper, or a CSV file with a column "
            "of times [s] and one per joint [rad, m].",
            autocompletion=complete_reference,
        ),
    ] = "sine",
    task: Annotated[
        str | None,
        typer.Option(
            "--task",
            help="Control the tool's pose and not the joints, by the law in a TaskSpace: swing, "
            "circle, line or hold. --reference is then left aside.",
            autocompletion=complete_task,
        ),
    ] = None,
    start_error: Annotated[float, typer.Option(help="Start error of each joint [rad, m].")] = 0.0,
    disturbance: Annotated[
        str,
        typer.Option(help="none, push (a tenth of the effort limits for 0.2 s), or paper."),
    ] = "none",
    event: Annotated[
        list[str] | None,
        typer.Option(
            help="What the true arm becomes at a time [s], TIME:option=value with an option about "
            "it: 3:payload=2 picks up 2 kg at 3 s, 6:payload=0 puts them down; may be repeated.",
            metavar="TIME:OPTION=VALUE",
        ),
    ] = None,
    wrench: Annotated[
        list[str] | None,
        typer.Option(
            help="Force [N] and torque [N·m] at the tool, or at a link, in the axes of the world, "
            "from START for DURATION [s]; may be repeated.",
            metavar="START:DURATION:FX,FY,FZ[,TX,TY,TZ][@LINK]",
        ),
    ] = None,
    sensors: SensorOptions,
    delay: Annotated[int, typer.Option(help="Ticks by which the torque comes late.")] = 0,
    duration: Annotated[
        float | None,
        typer.Option(help="Simulated time [s]; by default 10, or the length of the CSV file."),
    ] = None,
    dt: Annotated[float, typer.Option(help="Period of a tick [s].")] = 1e-3,
    substeps: Annotated[int, typer.Option(help="Steps of the integrator in a tick.")] = 1,
    integrator: Annotated[
        Literal["rk4", "semi-implicit"] | None,
        typer.Option(help="By default what the friction asks for."),
    ] = None,
    record_every: Annotated[int, typer.Option(help="Ticks from one recorded row to the next.")] = 1,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder for the results.")] = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page when done.")] = False,
    force: Force = False,
) -> None:
    """Simulate a controller on an arm that differs from what the controller believes."""
    from fotsmc_pin import simulate as run
    from fotsmc_pin.analysis import warn_of_soft_joints
    from fotsmc_pin.arms.rotors import warn_of_missing_rotors
    from fotsmc_pin.cli.run_disturbances import disturbance as disturbing
    from fotsmc_pin.cli.run_events import events, wrenches
    from fotsmc_pin.cli.run_references import task as find_reference
    from fotsmc_pin.cli.run_results import Told, keep_results
    from fotsmc_pin.cli.run_tasks import pose_task
    from fotsmc_pin.control import TaskSpace
    from fotsmc_pin.learning import ModelLearning
    from fotsmc_pin.references import warn_of_limits

    nominal = arm_options.load(arm)
    make_true = partial(_true_arm, nominal, true, options=arm_options)
    plant_arm = make_true(plant)
    bare: Any
    if task is None:
        course, bare = find_reference(reference, nominal), law.make(nominal, dt)
    else:
        course, bare = pose_task(task, nominal), TaskSpace(nominal, dt, law=law.make)
    seconds = course.duration if duration is None else duration
    folder = result_folder(out or Path("out") / file_name(nominal.name), force=force)
    pushes = wrenches(wrench or [], plant_arm, seconds)
    disturbed = disturbing(disturbance, plant_arm, seconds)
    changes = events(event or [], plant, make_true, seconds)
    sensor, actuator = sensors.make(nominal, dt, plant.seed), _actuator(delay)
    q0 = nominal.integrate(course.q_start, [start_error] * nominal.nv)
    warn_of_missing_rotors(nominal)
    if task is None:
        warn_of_limits(plant_arm, course.reference, seconds)
        warn_of_soft_joints(bare, plant_arm, encoder="motor", delay=delay)
    controller = ModelLearning(bare, delay=delay) if learn else bare
    told = Told(
        nominal=nominal,
        controller=controller,
        reference=course.words,
        true=true,
        disturbance=disturbance,
        noise=sensors.noise,
        delay=delay,
        start_error=start_error,
    )

    def simulated() -> Recording:
        return run(
            plant_arm,
            controller,
            course.reference,
            seconds,
            q0=q0,
            disturbance=[*pushes, *([] if disturbed is None else [disturbed])],
            events=changes,
            sensor=sensor,
            actuator=actuator,
            substeps=substeps,
            integrator=integrator,
            record_every=record_every,
            progress=True,
        )

    try:
        rec = simulated()
    except DivergenceError as error:
        error.recording.save(folder / "run.npz", progress=True)
        say_error(f"{error}. The run up to there is kept in {folder / 'run.npz'}")
        raise typer.Exit(2) from None
    except RunInterrupted as stop:
        stopped = stop.recording
        if not len(stopped):
            raise
        stopped.save(folder / "run.npz", progress=True)
        say_error(
            f"interrupted at t = {stopped.t[-1]:.4g} s; the run so far is kept in "
            f"{folder / 'run.npz'}"
        )
        raise typer.Exit(INTERRUPTED) from None
    page = keep_results(rec, told, folder)
    say(f"Open {page} in a browser; the run is kept in {folder / 'run.npz'}.")
    if open_page:
        webbrowser.open(page.resolve().as_uri())


def _true_arm(nominal: Arm, true: str | None, plant: PlantOptions, options: ArmOptions) -> Arm:
    from fotsmc_pin.cli.true_arm import load_true_arm

    if true is None:
        return plant.apply(nominal)
    loaded = load_true_arm(true, nominal, options)
    return plant.apply(loaded) if plant.asks_for_changes else loaded


def _actuator(delay: int) -> Actuator | None:
    from fotsmc_pin.simulation import TickDelay

    if delay == 0:
        return None
    if delay < 0:
        raise ArgumentError("--delay", delay, "give a whole number of ticks, at least 0")
    return TickDelay(delay)
