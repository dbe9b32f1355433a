"""`fotsmc stress`: controllers times arms times hard scenarios, as tables."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from fotsmc_pin.cli.arm_options import ArmNames, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.law_options import complete_law
from fotsmc_pin.cli.output import Force, plain_console, result_folder, say
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.files import write_json, write_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.table import Table

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.stress import StressRow

SHOWN_DRAWS = 10
DEFAULT_CASE = "sine raw"


@with_groups
def stress(
    arms: ArmNames,
    *,
    arm_options: ArmOptions,
    controller: Annotated[
        list[str] | None,
        typer.Option(
            help="Name of a law; may be repeated. All by default.",
            metavar="LAW",
            autocompletion=complete_law,
        ),
    ] = None,
    scenario: Annotated[
        list[str] | None,
        typer.Option(
            help="sine, hold, moves, rotors, delay, slow, stribeck, light, elastic, encoder, all, "
            "or one case such as 'hold raw'; may be repeated. 'sine raw' by default."
        ),
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
        int,
        typer.Option(
            help="Run the laws, RobustFONFTSM by default, in this many random scenarios instead."
        ),
    ] = 0,
    first_seed: Annotated[int, typer.Option(help="Seed of the first random scenario.")] = 0,
    learn: Annotated[
        bool,
        typer.Option(
            "--learn", help="Let every law learn its model while the arm moves; a PID does not."
        ),
    ] = False,
    duration: Annotated[
        float | None,
        typer.Option(help="Simulated time of a run [s]; by default each scenario's own."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the noise and of the search.")] = 0,
    jobs: Annotated[int, typer.Option(help="Processes on this machine; -1 for one per core.")] = 1,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the table as stress.md and stress.json.")
    ] = None,
    force: Force = False,
) -> None:
    """Put arms under stress: heavier than believed, with friction, noise, delay and start error."""
    from fotsmc_pin.evaluation.stress import chosen_cases, run_random_scenarios
    from fotsmc_pin.evaluation.stress import stress as run_suite

    chosen_cases(scenario or DEFAULT_CASE)
    if scenario and (draws or ablation or pid_trials):
        raise ArgumentError(
            "--scenario", scenario, "leave it out with --draws, --ablation and --pid-trials"
        )
    if ablation and learn:
        raise ArgumentError("--learn", learn, "leave it out with --ablation")
    if ablation and jobs != 1:
        raise ArgumentError("--jobs", jobs, "leave it out with --ablation, which is one process")
    folder = None if out is None else result_folder(out, force=force)
    rows: list[StressRow] = []
    seeds: list[int] = []
    for arm in [arm_options.load(name) for name in arms]:
        if draws:
            for law in controller or ["RobustFONFTSM"]:
                span = {} if duration is None else {"duration": duration}
                drawn = run_random_scenarios(
                    arm,
                    draws,
                    law=law,
                    first_seed=first_seed,
                    jobs=jobs,
                    learn=learn,
                    progress=True,
                    **span,
                )
                rows += [found.row for found in drawn]
                seeds += [found.seed for found in drawn]
        elif ablation:
            rows += _ablation(arm, seed, duration)
        else:
            rows += run_suite(
                [arm],
                controller,
                scenarios=scenario or DEFAULT_CASE,
                duration=duration,
                seed=seed,
                jobs=jobs,
                learn=learn,
                progress=True,
            )
        if pid_trials:
            rows.append(_best_pid(arm, pid_trials, pid_variation, seed, duration))
        if folder is not None:
            _write(folder, rows, seeds)
    console = plain_console()
    for table in _tables(rows, seeds, console.width):
        console.print(table)
    if folder is not None:
        say(f"The table is kept in {folder / 'stress.md'}.")


def _ablation(arm: Arm, seed: int, duration: float | None) -> list[StressRow]:
    from fotsmc_pin.evaluation.stress import ablate, stress_scenario
    from fotsmc_pin.evaluation.stress.judging import run_row
    from fotsmc_pin.evaluation.stress.scenario import DT

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
    duration: float | None,
) -> StressRow:
    from fotsmc_pin.control import RobustFONFTSM
    from fotsmc_pin.evaluation.stress import best_pid, stress_scenario
    from fotsmc_pin.evaluation.stress.judging import run_row
    from fotsmc_pin.evaluation.stress.scenario import DT

    scenario = stress_scenario(arm, seed=seed)
    largest = math.inf
    if variation > 0.0:
        rival = run_row(scenario, RobustFONFTSM(arm, DT), "", duration)
        largest = variation * rival.torque_variation
    row, gains = best_pid(
        scenario,
        trials=trials,
        seed=seed,
        duration=scenario.course.duration if duration is None else duration,
        largest_variation=largest,
        progress=True,
    )
    shown = ", ".join(f"{name} {value:.3g}" for name, value in gains.items())
    return replace(row, controller=f"best PID of {trials} ({shown})")


def _tables(rows: Sequence[StressRow], seeds: Sequence[int], width: int) -> Iterator[Table]:
    """Yield the tables for the terminal; of random scenarios, the ten worst of each law and arm."""
    from fotsmc_pin.evaluation.stress.table import is_matrix, listing, matrices, turned

    if is_matrix(rows):
        for title, lines in matrices(rows).items():
            needed = sum(2 + max(map(len, column)) for column in zip(*lines, strict=True))
            yield _table(title, lines if needed <= width else turned(lines), width)
        return
    if not seeds:
        yield _table("Stress suite", listing(rows), width)
        return
    groups: dict[tuple[str, str], list[tuple[StressRow, int]]] = {}
    for row, seed in zip(rows, seeds, strict=True):
        groups.setdefault((row.arm, row.controller), []).append((row, seed))
    for drawn in groups.values():
        worst = drawn[:SHOWN_DRAWS]
        lines = listing([row for row, _ in worst])
        for line, cell in zip(lines, ["seed", *(str(seed) for _, seed in worst)], strict=True):
            line.append(cell)
        yield _table(f"The worst of {len(drawn)} random scenarios", lines, width)


def _table(title: str, lines: Sequence[Sequence[str]], width: int) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from fotsmc_pin.learning.described import LABEL

    table = Table(
        title=title, title_justify="left", box=SIMPLE_HEAD, collapse_padding=True, pad_edge=False
    )
    named = [k for k, column in enumerate(lines[0]) if k == 0 or column == "controller"]
    # Names that leave no room for numbers are broken at their blanks.
    whole = sum(max(len(line[k]) for line in lines) for k in named) <= width // 2
    for k, column in enumerate(lines[0]):
        names = k in named
        justify: Literal["left", "right"] = "left" if names else "right"
        broken = names and not whole
        longest = max(len(word) for line in lines for word in line[k].split())
        table.add_column(
            column,
            justify=justify,
            no_wrap=names and not broken,
            width=longest if broken else None,
            overflow="fold",
        )
    for line in lines[1:]:
        # What cannot wrap and says the same in every row takes a line of its own.
        table.add_row(*(cell.replace(LABEL, f"\n{LABEL.strip()}") for cell in line))
    return table


def _write(folder: Path, rows: Sequence[StressRow], seeds: Sequence[int]) -> None:
    from fotsmc_pin.evaluation.stress import markdown

    data = [row.as_dict() | ({"seed": seeds[k]} if seeds else {}) for k, row in enumerate(rows)]
    write_json(folder / "stress.json", {"rows": data})
    write_text(folder / "stress.md", markdown(rows))
