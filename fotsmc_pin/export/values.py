"""What a translated expression is worth: a number, an array, named rows, or known beforehand."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping

PRIMARY, UNARY, TIMES, PLUS, LESS, EQUAL, AND, OR, TERNARY = 15, 14, 13, 12, 10, 9, 5, 4, 3
"""How tightly C's operators bind."""

REAL, INT, LONG, BOOL = "real", "int", "long", "bool"
"""Kinds of numbers. `LONG` is what `int()` makes of a real, and what counts with it."""


@dataclass
class Root:
    """Memory that arrays look at: whether anything of it is written.

    Attributes:
        written: whether an entry is assigned.
        views: what this is a view of, which is written as well.
    """

    written: bool = False
    views: Root | None = None

    def write(self) -> None:
        """Remember that an entry is assigned."""
        self.written = True
        if self.views is not None:
            self.views.write()


@dataclass(frozen=True)
class Constant:
    """What is known when the C is written: a number, a function, a class, a module.

    Attributes:
        value: what it is.
        decides: whether functions are written anew for it though it is a real: it stands in a
            table that never changes, such as the scheme of an operator.
    """

    value: Any
    decides: bool = False


@dataclass(frozen=True)
class Scalar:
    """A number that is known when the C runs."""

    kind: str
    code: str
    binding: int = PRIMARY

    def within(self, binding: int) -> str:
        """Return the code to stand in an operator that binds so tightly."""
        return self.code if self.binding >= binding else f"({self.code})"


@dataclass(frozen=True)
class Array:
    """Reals one after the other, the last index fastest.

    Attributes:
        code: pointer to the memory.
        shape: number of values of each index.
        root: what tells whether it is written.
        offset: entries of the memory before the first one.
        data: the entries, where they never change; the memory is then known everywhere by its name.
    """

    code: str
    shape: tuple[int, ...]
    root: Root = field(compare=False)
    offset: Scalar | Constant | None = None
    data: Any = field(default=None, compare=False)

    @property
    def stride(self) -> int:
        """Entries from one value of the first index to the next."""
        return math.prod(self.shape[1:])


@dataclass(frozen=True)
class Struct:
    """A C struct of named rows.

    Attributes:
        name: its C type.
        kind: the `NamedTuple` whose names it has.
        fields: shape of each member, () for a number; or the constant that stands for it.
        used: members that a kernel reads or writes.
    """

    name: str
    kind: Any
    fields: Mapping[str, tuple[int, ...] | Constant]
    used: set[str] = field(default_factory=set, compare=False)


@dataclass(frozen=True)
class Rows:
    """Named rows; `code` is a pointer to the struct, with what selects a member."""

    code: str
    struct: Struct
    root: Root = field(compare=False)


@dataclass(frozen=True)
class Table:
    """A table of rows that are reached by their names only; `code` is a pointer to its struct.

    Attributes:
        type_name: the C type of the struct.
        groups: members of it that are structs of named rows; the one without a name is itself.
        width: entries of a row.
    """

    code: str
    type_name: str
    groups: tuple[tuple[str, Struct], ...]
    width: int
    root: Root = field(compare=False)

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows, and of entries in each."""
        return sum(len(struct.fields) for _, struct in self.groups), self.width


@dataclass(frozen=True)
class Many:
    """A tuple."""

    items: tuple[Value, ...]


Value: TypeAlias = Constant | Scalar | Array | Rows | Table | Many


def kind_of(value: Value) -> str | None:
    """Return the kind of a number; None for what is none."""
    if isinstance(value, Scalar):
        return value.kind
    if isinstance(value, Constant):
        for kind, kinds in ((BOOL, bool), (INT, int), (REAL, float)):
            if isinstance(value.value, kinds):
                return kind
    return None


def signature(value: Value) -> Hashable:
    """Return what a function is written anew for: types, sizes and known values, but no reals."""
    match value:
        case Constant(number, decides=False) if isinstance(number, float):
            return REAL
        case Constant(known):
            return type(known).__name__, known if isinstance(known, str | int | float) else id(
                known
            )
        case Scalar():
            return value.kind
        case Array():
            return "array", value.shape, value.code if value.data is not None else None
        case Rows():
            return "rows", value.struct.name
        case Table():
            return "table", value.type_name
        case Many(items):
            return tuple(signature(item) for item in items)
