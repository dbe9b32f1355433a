"""`fotsmc export`: a tuned controller as C."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.law_options import LawOptions
from fotsmc_pin.cli.output import Force, result_folder, say


@with_groups
def export_command(
    arm: ArmName,
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the two files.")],
    arm_options: ArmOptions,
    law: LawOptions,
    dt: Annotated[float, typer.Option(help="Nominal period of a tick [s].")] = 1e-3,
    learn: Annotated[
        bool,
        typer.Option("--learn", help="With what learns the arm while it moves; knows of --delay."),
    ] = False,
    delay: Annotated[
        int, typer.Option(min=0, help="With --learn: ticks from a torque to the drive.")
    ] = 1,
    guarded: Annotated[
        bool,
        typer.Option("--safeguard", help="With soft start, watchdog and safe stop around the law."),
    ] = False,
    torque_rate: Annotated[
        float | None,
        typer.Option(help="With --safeguard: largest rate of each torque [N·m/s, N/s]."),
    ] = None,
    compensates: Annotated[
        str | None,
        typer.Option(
            help="With --safeguard: what the robot's drives add themselves, of gravity, coriolis "
            "and friction, with commas between."
        ),
    ] = None,
    single: Annotated[
        bool, typer.Option("--float", help="Numbers of single precision in place of double.")
    ] = False,
    force: Force = False,
) -> None:
    """Write a controller as C99 that needs math.h alone, for loops in hard real time."""
    from fotsmc_pin.control import Controller, Safeguard
    from fotsmc_pin.errors import ArgumentError
    from fotsmc_pin.export import export_c
    from fotsmc_pin.learning import ModelLearning

    if not guarded:
        if torque_rate is not None:
            remedy = "give --safeguard too, whose limit it is"
            raise ArgumentError("--torque-rate", torque_rate, remedy)
        if compensates is not None:
            remedy = "give --safeguard too, which takes it away"
            raise ArgumentError("--compensates", compensates, remedy)
    if single and learn:
        raise ArgumentError("--float", single, "leave it out: what learns is in double precision")
    bare = law.make(arm_options.load(arm), dt)
    controller = ModelLearning(bare, delay=delay) if learn else bare
    written: Controller | ModelLearning | Safeguard = controller
    if guarded:
        written = Safeguard(controller, torque_rate=torque_rate)
        written.compensates = tuple((compensates or "").replace(",", " ").split())
    folder = result_folder(out, force=force)
    header, source = export_c(written, folder, single=single)
    say(f"Written to {header} and {source}; the header says how to call it.")
