"""Columns of a table about an arm: `t [s]`, `q.JOINT [rad]`, `v.JOINT [rad/s]` and the like."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms.arm import Arm

TIME = "t"
SPELLINGS = {
    "s": ("s", "sec", "seconds"),
    "rad": ("rad", "radians"),
    "m": ("m",),
    "rad/s": ("rad/s",),
    "m/s": ("m/s",),
    "rad/s²": ("rad/s²", "rad/s^2", "rad/s2"),
    "m/s²": ("m/s²", "m/s^2", "m/s2"),
    "N·m": ("N·m", "Nm", "N m", "N*m", "N.m", "N⋅m"),
    "N": ("N",),
}
"""Units that are read, each with the ways in which people write it."""


@dataclass(frozen=True, kw_only=True)
class Column:
    """What the head of a column says.

    Attributes:
        kind: "t", "q", "v", "a", "tau", or a kind of its own; "" where the head is a bare name.
        joint: name of the joint; "" for the time.
        unit: as written in brackets, or "".
    """

    kind: str
    joint: str
    unit: str

    @classmethod
    def of(cls, head: str) -> Column:
        """Read `KIND.JOINT [UNIT]`, `JOINT [UNIT]` or `t [s]`; the unit may be missing."""
        name, bracket, rest = head.strip().partition("[")
        unit, name = rest.partition("]")[0].strip() if bracket else "", name.strip()
        if name == TIME:
            return cls(kind=TIME, joint="", unit=unit)
        kind, dot, joint = name.partition(".")
        if dot:
            return cls(kind=kind, joint=joint, unit=unit)
        return cls(kind="", joint=name, unit=unit)


def heads(arm: Arm, kinds: Sequence[str]) -> list[str]:
    """Return the heads of a table: the time, then each kind for all joints.

    Args:
        arm: the arm.
        kinds: as `units_of` takes them.
    """
    found = [f"{TIME} [s]"]
    for kind in kinds:
        units = units_of(arm, kind)
        found += [f"{kind}.{j} [{u}]" for j, u in zip(arm.joint_names, units, strict=True)]
    return found


def units_of(arm: Arm, kind: str) -> tuple[str, ...]:
    """Return the unit of a kind of column for each joint.

    Args:
        arm: the arm.
        kind: "q", "v" or "a", also with more behind (`q_measured`, `v_d`), the errors "e" and
            "e_dot", and any other for efforts.
    """
    plain = {"e": "q", "e_dot": "v"}.get(kind, kind.partition("_")[0])
    over = {"q": "", "v": "/s", "a": "/s²"}
    if plain in over:
        return tuple(unit + over[plain] for unit in arm.position_units)
    return arm.effort_units


def unit_flaw(head: str, unit: str, wanted: str) -> str | None:
    """Return what is wrong with the unit of a column and how to mend it, None where it is right.

    Args:
        head: of the column, as written.
        unit: as written in it.
        wanted: the unit that it must be.
    """
    if unit in SPELLINGS.get(wanted, (wanted,)):
        return None
    if not unit:
        return (
            f"column {head!r} states no unit: write {head.strip()} [{wanted}] if it is in {wanted}"
        )
    degrees = unit.lower().removesuffix("²").removesuffix("^2").removesuffix("s").rstrip("/")
    if degrees in ("deg", "degree", "degrees", "°") and wanted.startswith("rad"):
        remedy = f"multiply the column by π/180 and write [{wanted}]"
    elif unit in ("ms", "us", "µs", "ns") and wanted == "s":
        power = {"ms": 3, "us": 6, "µs": 6, "ns": 9}[unit]
        remedy = f"divide the column by 1e{power} and write [s]"
    elif unit in ("mm", "cm", "mm/s", "cm/s") and wanted in ("m", "m/s"):
        factor = 100 if unit.startswith("c") else 1000
        remedy = f"divide the column by {factor} and write [{wanted}]"
    else:
        remedy = f"convert the column, and write [{wanted}]"
    return f"column {head!r} is in {unit}: {remedy}"
