"""`fotsmc tune`: a law's gains for an arm, on the front between error and torque variation."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.law_options import DEFAULT_LAW, complete_law
from fotsmc_pin.cli.output import (
    INTERRUPTED,
    file_name,
    plain_console,
    plain_table,
    say,
    say_error,
)
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.files import markdown_table, write_json, write_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.table import Table

    from fotsmc_pin.analysis import Summary
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.tuning import FrontPoint


@with_groups
def tune(
    arm: ArmName,
    *,
    arm_options: ArmOptions,
    controller: Annotated[
        str,
        typer.Option(help="Name of the control law.", metavar="LAW", autocompletion=complete_law),
    ] = DEFAULT_LAW,
    trials: Annotated[int, typer.Option(help="Trials that are to be there at the end.")] = 100,
    objective: Annotated[
        str, typer.Option(help="Error to make small, such as rms_error or settling_time.")
    ] = "tail_rms_error",
    largest_torque: Annotated[
        float | None, typer.Option(help="Peak torque that a run may have [N·m].")
    ] = None,
    duration: Annotated[float, typer.Option(help="Simulated time of a run [s].")] = 6.0,
    seed: Annotated[int, typer.Option(help="Seed of the noise and of the search.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Folder; a search that lies there is gone on with.")
    ] = None,
) -> None:
    """Search gains in the stress scenario of an arm; stop it at any time and call it again."""
    from fotsmc_pin.analysis.metrics import UNITS
    from fotsmc_pin.checks import choice, count
    from fotsmc_pin.control import CONTROLLERS
    from fotsmc_pin.evaluation.stress.scenario import DT
    from fotsmc_pin.evaluation.stress.suite import law_maker
    from fotsmc_pin.evaluation.tuning import tune as search
    from fotsmc_pin.evaluation.tuning.front import OBJECTIVES
    from fotsmc_pin.evaluation.tuning.minimize import require_optuna
    from fotsmc_pin.view import front_figure, save_figure

    law = CONTROLLERS[choice("--controller", controller, [*CONTROLLERS])]
    choice("--objective", objective, OBJECTIVES)
    count("--trials", trials)
    require_optuna()
    nominal = arm_options.load(arm)
    start = law_maker(law)(nominal, DT).gains.as_dict()
    folder = out or Path("out") / file_name(f"tune_{nominal.name}_{controller}")
    run = _runner(law, nominal, start, seed, duration)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        front = search(
            law,
            run,
            folder / "search.log",
            start=start,
            trials=trials,
            objective=objective,
            largest_torque=largest_torque,
            seed=seed,
            about=_about(nominal, duration),
            progress=True,
        )
    except KeyboardInterrupt:
        say_error(
            f"interrupted; every finished trial is kept in {folder / 'search.log'}, and the same "
            "command goes on from there"
        )
        raise typer.Exit(INTERRUPTED) from None
    except ArgumentError as error:
        if error.argument == "path":
            raise ArgumentError("--out", str(folder), error.remedy) from None
        raise
    if not front:
        say("Every trial diverged or broke its torque limit.")
        raise typer.Exit(1)
    write_json(
        folder / "front.json",
        {
            "law": controller,
            "arm": nominal.name,
            "objective": objective,
            "front": [point.as_dict() | {"gains": start | point.gains} for point in front],
        },
    )
    points = [(point.error, point.torque_variation) for point in front]
    unit = UNITS[objective]
    shown = front_figure(points, f"{objective.replace('_', ' ')} [{unit}]")
    save_figure(shown, folder / "front.png")
    heading = f"{objective} [{unit}]"
    write_text(folder / "front.md", _markdown(front, heading))
    plain_console().print(_table(front, heading))
    say(f"The front is in {folder / 'front.md'} and {folder / 'front.png'}. Run its first point:")
    say(f"fotsmc simulate {arm} --gains {folder / 'front.json'}#1")


def _about(arm: Arm, duration: float) -> dict[str, Any]:
    """Return what a search depends on beside the law: the arm as it was understood, and the run."""
    digest = hashlib.sha256(f"{arm.urdf} {arm.tool_frame}".encode()).hexdigest()[:16]
    return {"arm": arm.name, "content of the URDF (digest)": digest, "duration [s]": duration}


def _runner(
    law: type[Controller], arm: Arm, start: dict[str, Any], seed: int, duration: float
) -> Callable[[dict[str, Any]], Summary | None]:
    """Return what runs gains in the stress scenario."""
    from fotsmc_pin.analysis import summarize
    from fotsmc_pin.errors import DivergenceError
    from fotsmc_pin.evaluation.stress import stress_scenario
    from fotsmc_pin.evaluation.stress.scenario import DT

    scenario = stress_scenario(arm, seed=seed)

    def run(gains: dict[str, Any]) -> Summary | None:
        try:
            return summarize(scenario.run(law(arm, DT, **(start | gains)), duration))
        except DivergenceError:
            return None

    return run


def _cells(point: FrontPoint) -> tuple[str, str, str]:
    gains = ", ".join(f"{name}={value:.4g}" for name, value in point.gains.items())
    return f"{point.error:.3g}", f"{point.torque_variation:.4g}", gains


def _table(front: Sequence[FrontPoint], error: str) -> Table:
    table = plain_table("Gains that no others beat in both error and torque variation")
    table.add_column("#", justify="right")
    for column in (error, "torque variation [N·m/s]", "gains"):
        table.add_column(column, overflow="fold")
    for number, point in enumerate(front, 1):
        table.add_row(str(number), *_cells(point))
    return table


def _markdown(front: Sequence[FrontPoint], error: str) -> str:
    head = (error, "torque variation [N·m/s]", "gains")
    return markdown_table(head, map(_cells, front), align="rrl")
