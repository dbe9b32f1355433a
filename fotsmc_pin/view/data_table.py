"""A recording as named columns with units, for the files that other programs read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.arms.columns import units_of
from fotsmc_pin.references.path import unwrapped

if TYPE_CHECKING:
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array

MOTION = ("q", "v", "q_d", "v_d", "e", "e_dot")
READINGS = ("q_measured", "v_measured")
CONFIGURATIONS = ("q", "q_d", "q_measured")
TORQUE = "tau_commanded"
"""Name of the torque that was applied, beside `tau_measured`, which a sensor read."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """Columns of one kind: a value for each joint, or the parts of a signal.

    Attributes:
        kind: "q", "v", "tau_commanded" and the like, or the name of a signal.
        names: of the columns: joints, or numbers from 0.
        units: of the columns; "" where none is stated.
        values: (N, columns).
    """

    kind: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array

    @property
    def heads(self) -> list[str]:
        """Heads of the columns, such as `q.elbow [rad]`."""
        pairs = zip(self.names, self.units, strict=True)
        return [f"{self.kind}.{name}" + (f" [{unit}]" if unit else "") for name, unit in pairs]


def blocks_of(rec: Recording) -> list[Block]:
    """Return all columns of a recording but the time; a continuous joint by its angle [rad].

    Signals stand last. One with a column for each joint is named by the joints; signals state no
    unit.
    """
    arm = rec.arm
    tables = {kind: getattr(rec, kind) for kind in (*MOTION, *READINGS)}
    tables |= {TORQUE: rec.tau, "tau_measured": rec.tau_measured}
    for kind in CONFIGURATIONS:
        if tables[kind] is not None and arm.nq != arm.nv:
            tables[kind] = unwrapped(arm, kind, tables[kind])
    found = [
        Block(kind=kind, names=arm.joint_names, units=units_of(arm, kind), values=table)
        for kind, table in tables.items()
        if table is not None
    ]
    for kind, table in rec.signals.items():
        values = table.reshape(len(rec), -1)
        parts = values.shape[1]
        names = arm.joint_names if parts == arm.nv else tuple(map(str, range(parts)))
        found.append(Block(kind=kind, names=names, units=("",) * parts, values=values))
    return found
