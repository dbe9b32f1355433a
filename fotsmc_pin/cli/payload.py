"""`fotsmc payload`: what the tool of a known arm holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fotsmc_pin.cli.arm_options import ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.log_options import LogOptions, Logs
from fotsmc_pin.cli.output import Force, result_file, say


@with_groups
def payload_command(
    logs: Logs,
    *,
    urdf: Annotated[
        str, typer.Option("--urdf", help="The arm without the payload: a URDF file, or a name.")
    ],
    empty: Annotated[
        list[Path] | None,
        typer.Option(
            help="A log without the payload, to identify the arm from first; may be repeated."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The URDF of the arm with the payload, to write."),
    ] = None,
    log_options: LogOptions,
    arm_options: ArmOptions,
    force: Force = False,
) -> None:
    """Find mass, centre of mass and inertia of what the tool holds."""
    from fotsmc_pin.identification import identify_payload

    target = None if out is None else result_file(out, force=force)
    arm = arm_options.load(urdf)
    found = identify_payload(
        log_options.read(logs, arm),
        arm,
        empty=log_options.read(empty or [], arm),
        progress=True,
    )
    say(str(found))
    rows = ", ".join(f"({x:.3g}, {y:.3g}, {z:.3g})" for x, y, z in found.inertia.tolist())
    say(f"inertia about the centre of mass {rows} kg·m²")
    for line in found.notes:
        say(line)
    if target is not None:
        found.arm.write_urdf(target)
        say(f"Written to {target}.")
