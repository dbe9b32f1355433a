"""`fotsmc perturb`: a second URDF, for the true plant, made from the first."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.output import Force, result_file, say
from fotsmc_pin.cli.plant_options import PlantOptions


@with_groups
def perturb_command(
    file: ArmName,
    *,
    out: Annotated[Path, typer.Option("--out", "-o", help="The URDF to write.")],
    plant: PlantOptions,
    arm_options: ArmOptions,
    force: Force = False,
) -> None:
    """Write a URDF whose masses, friction or payload differ: the plant that a model misses."""
    target = result_file(out, force=force)
    arm = arm_options.load(file)
    true = plant.apply(arm)
    true.write_urdf(target)
    for line in (*arm.notes, *(true.changes or ("nothing changed",))):
        say(f"  {line}")
    say(f"Written to {target}.")
