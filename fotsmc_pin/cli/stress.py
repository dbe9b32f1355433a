"""`fotsmc stress`: controllers times arms in one hard scenario, as a table."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from fotsmc_pin.cli.output import Force, plain_console, result_folder
from fotsmc_pin.files import write_json, write_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.stress import StressRow

SHOWN_DRAWS = 10


def stress(
    arms: Annotated[list[str], typer.Argument(help="URDF files, or names of `fotsmc arms`.")],
    controller: Annotated[
        list[str] | None, typer.Option(help="Name of a law; may be repeated. All by default.")
    ] = None,
    pid_trials: Annotated[
        int, typer.Option(help="Add the best PID that this many trials find on each arm.")
    ] = 0,
    pid_variation: Annotated[
        float,
        typer.Option(
            help="Bound on that PID's torque variation, over RobustFONFTSM's; 0 for none."
        ),
    ] = 2.0,
    ablation: Annotated[
        bool, typer.Option("--ablation", help="RobustFONFTSM without each of its ingredients.")
    ] = False,
    draws: Annotated[
        int, typer.Option(help="Run RobustFONFTSM in this many random scenarios instead.")
    ] = 0,
    first_seed: Annotated[int, typer.Option(help="Seed of the first random scenario.")] = 0,
    duration: Annotated[float, typer.Option(help="Simulated time of a run [s].")] = 6.0,
    seed: Annotated[int, typer.Option(help="Seed of the noise and of the search.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the table as stress.md and stress.json.")
    ] = None,
    force: Force = False,
) -> None:
    """Put arms under stress: heavier than believed, with friction, noise, delay and start error."""
    from fotsmc_pin.arms import load_arm
    from fotsmc_pin.evaluation.stress import run_random_scenarios
    from fotsmc_pin.evaluation.stress import stress as run_suite

    folder = None if out is None else result_folder(out, force=force)
    rows: list[StressRow] = []
    seeds: list[int] = []
    for name in arms:
        arm = load_arm(name)
        if draws:
            drawn = run_random_scenarios(arm, draws, first_seed=first_seed, progress=True)
            rows += [found.row for found in drawn]
            seeds += [found.seed for found in drawn]
        elif ablation:
            rows += _ablation(arm, seed, duration)
        else:
            rows += run_suite([arm], controller, duration=duration, seed=seed, progress=True)
        if pid_trials:
            rows.append(_best_pid(arm, pid_trials, pid_variation, seed, duration))
        if folder is not None:
            _write(folder, rows, seeds)
    console = plain_console()
    console.print(_table(rows, seeds))
    if folder is not None:
        console.print(f"The table is kept in {folder / 'stress.md'}.")


def _ablation(arm: Arm, seed: int, duration: float) -> list[StressRow]:
    from fotsmc_pin.evaluation.stress import ablate, stress_scenario
    from fotsmc_pin.evaluation.stress.scenario import DT
    from fotsmc_pin.evaluation.stress.judging import run_row

    scenario = stress_scenario(arm, seed=seed)
    rows = ablate(
        lambda law, label: run_row(scenario, law, label, duration), arm, DT, progress=True
    )
    if arm.name == "two_link":
        rows += ablate(_printed_case, arm, DT, progress=True)
    return rows


def _printed_case(law: Controller, label: str) -> StressRow:
    """Judge a run of the paper's two-link case with its printed disturbance."""
    from fotsmc_pin.evaluation.stress import judge
    from fotsmc_pin.paper.two_link import run

    return judge(run(law), "two_link, printed case", label)


def _best_pid(
    arm: Arm,
    trials: int,
    variation: float,
    seed: int,
    duration: float,
) -> StressRow:
    from fotsmc_pin.control import RobustFONFTSM
    from fotsmc_pin.evaluation.stress import best_pid, stress_scenario
    from fotsmc_pin.evaluation.stress.scenario import DT
    from fotsmc_pin.evaluation.stress.judging import run_row

    scenario = stress_scenario(arm, seed=seed)
    largest = math.inf
    if variation > 0.0:
        rival = run_row(scenario, RobustFONFTSM(arm, DT), "", duration)
        largest = variation * rival.torque_variation
    row, gains = best_pid(
        scenario,
        trials=trials,
        seed=seed,
        duration=duration,
        largest_variation=largest,
        progress=True,
    )
    shown = ", ".join(f"{name} {value:.3g}" for name, value in gains.items())
    return replace(row, controller=f"best PID of {trials} ({shown})")


def _table(rows: Sequence[StressRow], seeds: Sequence[int]) -> Table:
    """Return the rows for the terminal; of random scenarios, the ten worst."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from fotsmc_pin.evaluation.stress.table import COLUMNS, cells

    title = f"The worst of {len(seeds)} random scenarios" if seeds else "Stress suite"
    table = Table(
        title=title, title_justify="left", box=SIMPLE_HEAD, collapse_padding=True, pad_edge=False
    )
    for k, column in enumerate((*COLUMNS, "seed") if seeds else COLUMNS):
        names = k < 2
        justify: Literal["left", "right"] = "left" if names else "right"
        table.add_column(column, justify=justify, no_wrap=names, overflow="fold")
    for k, row in enumerate(rows[:SHOWN_DRAWS] if seeds else rows):
        table.add_row(*cells(row), *([str(seeds[k])] if seeds else []))
    return table


def _write(folder: Path, rows: Sequence[StressRow], seeds: Sequence[int]) -> None:
    from fotsmc_pin.evaluation.stress import markdown

    data = [row.as_dict() | ({"seed": seeds[k]} if seeds else {}) for k, row in enumerate(rows)]
    write_json(folder / "stress.json", {"rows": data})
    write_text(folder / "stress.md", markdown(rows))
