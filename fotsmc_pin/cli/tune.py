"""`fotsmc tune`: a law's gains for an arm, on the front between error and torque variation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.output import plain_console
from fotsmc_pin.files import markdown_table, write_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.table import Table

    from fotsmc_pin.analysis import Summary
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.tuning import FrontPoint


def tune(
    arm: Annotated[str, typer.Argument(help="A URDF file, or a name that `fotsmc arms` lists.")],
    controller: Annotated[str, typer.Option(help="Name of the control law.")] = "RobustFONFTSM",
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
    from fotsmc_pin.arms import load_arm
    from fotsmc_pin.checks import choice
    from fotsmc_pin.control import CONTROLLERS
    from fotsmc_pin.evaluation.stress.scenario import DT
    from fotsmc_pin.evaluation.stress.suite import law_maker
    from fotsmc_pin.evaluation.tuning import tune as search
    from fotsmc_pin.view import front_figure, save_figure

    law = CONTROLLERS[choice("--controller", controller, [*CONTROLLERS])]
    nominal = load_arm(arm)
    start = law_maker(law)(nominal, DT).gains.as_dict()
    folder = out or Path("out") / f"tune_{nominal.name}_{controller}"
    folder.mkdir(parents=True, exist_ok=True)
    front = search(
        law,
        _runner(law, nominal, start, seed, duration),
        folder / "search.log",
        start=start,
        trials=trials,
        objective=objective,
        largest_torque=largest_torque,
        seed=seed,
        progress=True,
    )
    console = plain_console()
    if not front:
        console.print("Every trial diverged or broke its torque limit.")
        return
    points = [(point.error, point.torque_variation) for point in front]
    unit = UNITS[objective]
    shown = front_figure(points, f"{objective.replace('_', ' ')} [{unit}]")
    save_figure(shown, folder / "front.png")
    error = f"{objective} [{unit}]"
    write_text(folder / "front.md", _markdown(front, error))
    console.print(_table(front, error))
    console.print(f"The front is in {folder / 'front.md'} and {folder / 'front.png'}.")


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
    from rich.table import Table

    table = Table(
        title="Gains that no others beat in both error and torque variation", title_justify="left"
    )
    for column in (error, "torque variation [N·m/s]", "gains"):
        table.add_column(column)
    for point in front:
        table.add_row(*_cells(point))
    return table


def _markdown(front: Sequence[FrontPoint], error: str) -> str:
    head = (error, "torque variation [N·m/s]", "gains")
    return markdown_table(head, map(_cells, front), align="rrl")
