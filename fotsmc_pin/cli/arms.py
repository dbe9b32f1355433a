"""`fotsmc arms`: the arms that go by a name on this machine."""

from __future__ import annotations

import importlib.util
import math
from typing import TYPE_CHECKING

from fotsmc_pin.cli.output import plain_console, plain_table

if TYPE_CHECKING:
    from fotsmc_pin.arms import Inspection


def arms_command() -> None:
    """List the arms that go by a name here: joints, mass, limits known, and what they can lift."""
    from fotsmc_pin.arms import inspect_arm, load_arm
    from fotsmc_pin.arms.catalog import example_robots_folder, known_names

    table = plain_table("Arms")
    table.add_column("name", no_wrap=True)
    table.add_column("joints", justify="right")
    table.add_column("moving mass [kg]", justify="right")
    table.add_column("limits known")
    table.add_column("payload guess [kg]", justify="right")
    table.add_column("locked")
    for name in known_names():
        found = inspect_arm(load_arm(name), samples=100)
        locked = [note.split()[1] for note in found.arm.notes if note.startswith("locked ")]
        table.add_row(
            name,
            str(found.arm.nv),
            f"{found.total_mass:.3g}",
            _limits_known(found),
            _payload(found),
            ", ".join(locked),
        )
    console = plain_console()
    console.print(table)
    console.print(
        "Payload guess: the mass at the tool frame that the effort limits hold still in each of "
        "100 random configurations."
    )
    if example_robots_folder() is None:
        console.print("More arms come with: pip install example-robot-data")
    if importlib.util.find_spec("robot_descriptions") is not None:
        console.print("Names of robot_descriptions do as well; it fetches a robot when first used.")
    console.print("Any URDF file does as well: fotsmc inspect my.urdf")


def _limits_known(found: Inspection) -> str:
    known = [
        what
        for what, values in (
            ("effort", found.arm.effort_limit),
            ("velocity", found.arm.velocity_limit),
            ("position", found.arm.upper_position_limit),
        )
        if any(map(math.isfinite, values))
    ]
    return ", ".join(known) or "none"


def _payload(found: Inspection) -> str:
    if math.isinf(found.payload):
        return "-"
    return "none" if found.payload == 0.0 else f"{found.payload:.2g}"
