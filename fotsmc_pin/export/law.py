"""What of a control law goes into C: its structs, its tables, its first memory, its tick."""

from __future__ import annotations

import copy
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.control.arguments import read_arguments
from fotsmc_pin.control.rows import Joints, row_names
from fotsmc_pin.export.dialect import identifier
from fotsmc_pin.export.values import Array, Constant, Root, Scalar, Struct, Table

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.control import Controller
    from fotsmc_pin.export.program import Function, Program
    from fotsmc_pin.export.values import Value
    from fotsmc_pin.types import Array as Numbers


class _Watched:
    """Gains that remember which of them were read."""

    def __init__(self, gains: Any) -> None:
        self._gains, self.read = gains, set[str]()

    def __getattr__(self, name: str) -> Any:
        self.read.add(name)
        return getattr(self._gains, name)


@dataclass(frozen=True)
class Law:
    """A law, translated.

    Attributes:
        controller: the controller, freshly reset, a copy.
        gains: the gains in force.
        fixed: gains that the tables are made from.
        structs: joints, gains, memory and work, by their member in the state.
        tables: coefficients of each fractional operator.
        memories: their memory at the start.
        tick: the C function of a tick.
        read: the C function that reads the arguments.
    """

    controller: Controller
    gains: Any
    fixed: frozenset[str]
    structs: Mapping[str, Struct]
    tables: Mapping[str, Numbers]
    memories: Mapping[str, Numbers]
    tick: Function
    read: Function

    @classmethod
    def of(cls, controller: Controller, program: Program, prefix: str, state: str) -> Law:
        """Translate a law.

        Args:
            controller: any controller; it stays as it is.
            program: where its functions are written.
            prefix: what all names of the program begin with.
            state: type of the law's state.

        Raises:
            TranslationError: its kernel contains what is not translated.
        """
        twin = copy.deepcopy(controller)
        twin.reset()
        n, gains = twin.arm.nv, twin.effective_gains()
        watched = _Watched(gains)
        for operator in twin.streams.values():
            operator(watched, twin.dt)
        fixed = frozenset(watched.read)
        structs = {
            "joints": Struct(f"{prefix}_joints", Joints, _vectors(Joints, n)),
            "gains": Struct(f"{prefix}_gains", row_names(twin.Gains), _gains(gains, fixed, n)),
            "memory": Struct(f"{prefix}_memory", twin.State, _vectors(twin.State, n)),
            "work": Struct(f"{prefix}_work", twin.Work, _vectors(twin.Work, n)),
        }
        tables = {name: np.array(s.coefficients) for name, s in twin.memories.items()}
        memories = {name: s.memory for name, s in twin.memories.items()}
        root = Root()
        arguments: list[Value] = [
            Scalar("real", "dt"),
            Table("state", state, tuple(structs.items()), n, root),
            Array("M", (n, n), Root()),
            Array("h", (n,), Root()),
        ]
        for name, table in tables.items():
            place = f"{identifier(name)}_table"
            arguments.append(Array(place, table.shape, Root(), data=table))
            arguments.append(Array(f"state->{name}", memories[name].shape, root))
        tick = program.function(type(twin).tick, arguments, caller=None, node=None)
        return cls(
            twin,
            gains,
            fixed,
            structs,
            tables,
            memories,
            tick,
            _reader(twin, program, structs["joints"]),
        )

    @property
    def live_gains(self) -> list[str]:
        """Gains that the tick reads and that may change while it runs, in their order."""
        struct = self.structs["gains"]
        names = [field.name for field in fields(self.gains)]
        return [name for name in names if name in struct.used]

    def first_rows(self) -> dict[str, dict[str, Numbers]]:
        """Return the rows that are not zero at the start, by group and name."""
        groups = {"memory": self.controller.state, "work": self.controller._work}
        found: dict[str, dict[str, Numbers]] = {}
        for group, rows in groups.items():
            found[group] = {k: row.copy() for k, row in rows._asdict().items() if row.any()}
        return found


def _vectors(names: Any, n: int) -> dict[str, tuple[int, ...] | Constant]:
    return dict.fromkeys(names._fields, (n,))


def _gains(gains: Any, fixed: frozenset[str], n: int) -> dict[str, tuple[int, ...] | Constant]:
    found: dict[str, tuple[int, ...] | Constant] = {}
    for field in fields(gains):
        whole = field.metadata["kind"] == "per joint"
        value = getattr(gains, field.name)
        if field.name in fixed and not whole:
            choices = field.metadata.get("choices", ())
            number = choices.index(value) if isinstance(value, str) else value
            found[field.name] = Constant(float(number))
        else:
            found[field.name] = (n,) if whole else ()
    return found


def _reader(controller: Controller, program: Program, joints: Struct) -> Function:
    n, nq = controller.arm.nv, controller.arm.nq
    sizes = {"q": nq, "v": n, "q_d": nq, "v_d": n, "a_d": n}
    values: list[Value] = [Array(name, (size,), Root()) for name, size in sizes.items()]
    values.append(Array("places", (2, nq), Root()))
    values.append(Table("seen", joints.name, (("", joints),), n, Root()))
    return program.function(read_arguments, values, caller=None, node=None)
