"""`fotsmc identify`: from logs of a robot to the URDF that explains them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.cli.arm_options import ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.log_options import LogOptions, Logs
from fotsmc_pin.cli.output import Force, plain_console, plain_table, result_file, say

if TYPE_CHECKING:
    from fotsmc_pin.identification import Identification, TorqueCheck


@with_groups
def identify_command(
    logs: Logs,
    *,
    urdf: Annotated[str, typer.Option("--urdf", help="The nominal arm: a URDF file, or a name.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The URDF to write.")],
    validate: Annotated[
        list[Path] | None,
        typer.Option(help="A log that is not fitted but predicted; may be repeated."),
    ] = None,
    offset: Annotated[
        bool, typer.Option("--offset", help="Find a constant torque of each joint too.")
    ] = False,
    stribeck: Annotated[
        bool, typer.Option("--stribeck", help="Find friction at breakaway too.")
    ] = False,
    page: Annotated[
        Path | None,
        typer.Option("--report", help="The page to write; by default beside the URDF."),
    ] = None,
    log_options: LogOptions,
    arm_options: ArmOptions,
    force: Force = False,
) -> None:
    """Find masses, inertias, rotors and friction that explain recorded torque."""
    from fotsmc_pin.identification import identify
    from fotsmc_pin.view.identification_report import write_identification

    target = result_file(out, force=force)
    report = result_file(page or out.with_suffix(".html"), force=force)
    arm = arm_options.load(urdf)
    result = identify(
        log_options.read(logs, arm),
        arm,
        validate=log_options.read(validate or [], arm),
        offset=offset,
        stribeck=stribeck,
        progress=True,
    )
    result.write_urdf(target)
    write_identification(result, report)
    for check in result.fits:
        show_torque(result, check, "fitted")
    for check in result.validation:
        show_torque(result, check, "predicted")
    _show_joints(result)
    for line in (*result.notes, *result.unidentifiable):
        say(line)
    say(f"Written to {target}; {report} has every parameter.")


def show_torque(result: Identification, check: TorqueCheck, how: str) -> None:
    """Print the errors of the torque of one log."""
    from fotsmc_pin.view.identification_report import TORQUE_HEAD, torque_rows

    table = plain_table(f"{check.label}, {how}: RMS of measured minus predicted torque")
    for k, head in enumerate(TORQUE_HEAD):
        table.add_column(head, justify="left" if k == 0 else "right")
    for row in torque_rows(result, check):
        table.add_row(*row)
    plain_console().print(table)


def _show_joints(result: Identification) -> None:
    groups = [name for name in ("armature", "damping", "friction") if result.group(name)]
    table = plain_table("Joints, with standard deviations")
    table.add_column("joint")
    for name in groups:
        table.add_column(f"{name} [{result.group(name)[0].unit}]", justify="right")
    for j, joint in enumerate(result.arm.joint_names):
        rows = [result.group(name)[j] for name in groups]
        table.add_row(joint, *(f"{row.value:.3g} ± {row.deviation:.1g}" for row in rows))
    plain_console().print(table)
