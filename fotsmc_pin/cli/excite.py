"""`fotsmc excite`: a motion from which the parameters of an arm can be told, as a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.output import Force, plain_console, plain_table, result_file, say, show_table

if TYPE_CHECKING:
    from rich.table import Table

    from fotsmc_pin.references import Excitation
    from fotsmc_pin.types import Array

BOUNDS = "How far, how fast and how hard"


@with_groups
def excite(
    arm: ArmName,
    *,
    arm_options: ArmOptions,
    seed: Annotated[int, typer.Option(help="Of the search; another seed, another motion.")] = 0,
    period: Annotated[float, typer.Option(help="Period of the motion [s].")] = 10.0,
    repetitions: Annotated[int, typer.Option(help="How often the period is run.")] = 3,
    harmonics: Annotated[int, typer.Option(help="Number of frequencies of each joint.")] = 8,
    position_margin: Annotated[
        float,
        typer.Option(
            help="Share of a joint's range left free at each end.", rich_help_panel=BOUNDS
        ),
    ] = 0.05,
    velocity_share: Annotated[
        float,
        typer.Option(
            help="Share of the velocity and acceleration limits in use.", rich_help_panel=BOUNDS
        ),
    ] = 0.8,
    acceleration_limit: Annotated[
        float | None,
        typer.Option(
            help="Of every joint [rad/s², m/s²]; by default what reaches the velocity limit within "
            "0.2 s.",
            rich_help_panel=BOUNDS,
        ),
    ] = None,
    effort_share: Annotated[
        float, typer.Option(help="Share of the effort limits in use.", rich_help_panel=BOUNDS)
    ] = 0.6,
    clearance: Annotated[
        float, typer.Option(help="Least distance between links [m].", rich_help_panel=BOUNDS)
    ] = 0.01,
    floor: Annotated[
        float | None,
        typer.Option(
            help="Height of a floor or table in the frame of the world [m]: no link goes below.",
            rich_help_panel=BOUNDS,
        ),
    ] = None,
    rate: Annotated[float, typer.Option(help="Rows of the file in a second [1/s].")] = 100.0,
    out: Annotated[Path, typer.Option("--out", "-o", help="The CSV file.")] = Path("motion.csv"),
    force: Force = False,
) -> None:
    """Design a periodic motion that makes the parameters of an arm visible."""
    from fotsmc_pin.references import Excitation

    path = result_file(out, force=force)
    nominal = arm_options.load(arm)
    motion = Excitation(
        nominal,
        seed,
        period=period,
        repetitions=repetitions,
        harmonics=harmonics,
        position_margin=position_margin,
        velocity_share=velocity_share,
        acceleration_limit=acceleration_limit,
        effort_share=effort_share,
        clearance=clearance,
        floor=floor,
        progress=True,
    )
    motion.to_csv(path, rate=rate)
    show_table(nominal.name, _rows(motion))
    console = plain_console()
    console.print(visible_table(motion))
    say("No motion shows what no column names. A sum is told; how it is shared among links is not.")
    say(f"The motion is in {path}. Move to its first row, slowly, before you run it.")


def _rows(motion: Excitation) -> list[tuple[str, str]]:
    import numpy as np

    arm, room = motion.arm, motion.room
    t = np.arange(0.0, motion.period, 0.01)
    _, v, a = motion.joint_motion(t)
    efforts = np.array([arm.inverse_dynamics(*motion(float(instant))) for instant in t])

    def share(values: Array, bounds: Array) -> str:
        used = np.abs(values).max(axis=0) / bounds
        return f"at most {100 * used.max():.0f} % ({arm.joint_names[int(used.argmax())]})"

    start = ", ".join(f"{x:.3f}" for x in motion.joint_motion(np.zeros(1))[0][0])
    pairs = len(motion.collision_pairs)
    return [
        ("motion", f"{motion.repetitions} periods of {motion.period:g} s, seed {motion.seed}"),
        ("begins and ends at rest at", f"{start} [{', '.join(sorted(set(arm.position_units)))}]"),
        ("speed, of the limit in use", share(v, room.velocity)),
        ("acceleration, of the limit in use", share(a, room.acceleration)),
        ("effort, of the limits", share(efforts, room.effort_limit)),
        (
            "self-collision",
            f"none: {pairs} pairs of shapes stay {motion.clearance:g} m apart"
            if pairs
            else "not looked at: the file has no collision shapes",
        ),
        ("condition number", f"{motion.condition_number:.4g} (scaled base parameters)"),
    ]


def visible_table(motion: Excitation) -> Table:
    """Return the table of what a motion makes visible, a row for each joint and its link."""
    table = plain_table("Visible parameters (m mass, mx… first moments, I… inertia)")
    for head in ("joint and its link", "by themselves", "in sums with others", "hardly"):
        table.add_column(head, overflow="fold")
    for joint in motion.arm.joint_names:
        seen = [item for item in motion.seen if item.body == joint]
        columns = (
            [item.parameter for item in seen if item.well and item.alone],
            [item.parameter for item in seen if item.well and not item.alone],
            [item.parameter for item in seen if item.acts and not item.well],
        )
        table.add_row(joint, *(" ".join(names) or "-" for names in columns))
    return table
