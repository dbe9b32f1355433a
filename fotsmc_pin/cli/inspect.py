"""`fotsmc inspect`: what was understood of a URDF, and what looks wrong in it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.output import plain_console, plain_table

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from fotsmc_pin.arms import Inspection


@with_groups
def inspect_command(
    file: ArmName,
    arm_options: ArmOptions,
    samples: Annotated[int, typer.Option(help="Number of random configurations.")] = 200,
    seed: Annotated[int, typer.Option(help="Where they are drawn from.")] = 0,
) -> None:
    """Say what was understood of a URDF: joints, limits, loads, and what looks wrong."""
    from fotsmc_pin.arms import inspect_arm

    arm = arm_options.load(file)
    found = inspect_arm(arm, samples=samples, seed=seed)
    console = plain_console()
    console.print(_joints(found))
    console.print(_loads(found))
    _say(console, _facts(found))
    for remark in found.remarks:
        _say(console, ["", remark])
    if arm.notes:
        _say(console, ["", "Decided while loading:", *(f"  {note}" for note in arm.notes)])
    if found.warnings:
        _say(console, ["", "Looks wrong:", *(f"  {warning}" for warning in found.warnings)])
    else:
        _say(console, ["", "Nothing looks wrong."])


def _say(console: Console, lines: list[str]) -> None:
    for line in lines:
        console.print(line, highlight=False)


def _facts(found: Inspection) -> list[str]:
    arm = found.arm
    payload = (
        "no effort limits bear on it" if math.isinf(found.payload) else f"{found.payload:.3g} kg"
    )
    median, largest = found.condition
    lines = [
        f"Moving mass {found.total_mass:.4g} kg, tool frame {arm.tool_frame}.",
        f"Condition number of the mass matrix: {median:.3g} in the median, {largest:.3g} at most.",
        f"Payload that the limits still hold everywhere: {payload}.",
    ]
    if not arm.is_euclidean:
        lines.append(
            f"Continuous joints: {arm.nq} position coordinates for {arm.nv} degrees of freedom."
        )
    return lines


def _joints(found: Inspection) -> Table:
    """Joints and their limits, each with where it comes from."""
    arm = found.arm
    table = plain_table(f"{arm.name}: limits as the file gives them")
    table.add_column("joint", no_wrap=True)
    table.add_column("type")
    for heading in ("position", "velocity", "effort"):
        table.add_column(heading, justify="right")
    for row, name in enumerate(arm.joint_names):
        unit, effort_unit = arm.position_units[row], arm.effort_units[row]
        kind = arm.tree.joints[name].type
        lower, upper = arm.lower_position_limit[row], arm.upper_position_limit[row]
        span = f"{_number(lower)} to {_number(upper)} {unit}"
        if math.isinf(lower) and math.isinf(upper):
            span = "endless" if kind == "continuous" else "not given"
        table.add_row(
            name,
            kind,
            span,
            _limit(arm.velocity_limit[row], f"{unit}/s"),
            _limit(arm.effort_limit[row], effort_unit),
        )
    return table


def _loads(found: Inspection) -> Table:
    """Loads, inertias and friction of the joints."""
    arm = found.arm
    table = plain_table("Loads over random configurations")
    table.add_column("joint", no_wrap=True)
    for heading in ("gravity", "of the limit", "inertia", "armature", "friction", "damping"):
        table.add_column(heading, justify="right")
    for row, name in enumerate(arm.joint_names):
        limited = math.isfinite(arm.effort_limit[row])
        least, most = found.inertia_range[row]
        mass_unit = "kg" if arm.position_units[row] == "m" else "kg·m²"
        table.add_row(
            name,
            f"{_load(found.gravity_load[row])} {arm.effort_units[row]}",
            f"{100 * found.gravity_share[row]:.0f} %" if limited else "-",
            f"{least:.2g} to {most:.2g} {mass_unit}",
            *(f"{values[row]:.3g}" for values in (arm.armature, arm.friction, arm.damping)),
        )
    return table


def _load(value: float) -> str:
    return f"{value:.3g}" if value > 1e-9 else "0"


def _limit(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}" if math.isfinite(value) else "not given"


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else ("-∞" if value < 0 else "∞")
