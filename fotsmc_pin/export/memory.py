"""Arrays, their entries and their parts as C; and numbers of one kind as those of another."""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from dataclasses import replace
from typing import TYPE_CHECKING

from fotsmc_pin.export.dialect import member_name
from fotsmc_pin.export.lines import Lines
from fotsmc_pin.export.values import (
    BOOL,
    INT,
    LONG,
    PLUS,
    REAL,
    TIMES,
    UNARY,
    Array,
    Constant,
    Many,
    Root,
    Rows,
    Scalar,
    kind_of,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.export.program import Program
    from fotsmc_pin.export.source import Source
    from fotsmc_pin.export.values import Value


class Memory(Lines, ABC):
    """Translates what reads memory.

    Attributes:
        written: memory of the entry that was translated last, for an assignment to it.
    """

    def __init__(self, program: Program, source: Source) -> None:
        super().__init__(program, source)
        self.written: Root | None = None

    @abstractmethod
    def value(self, node: ast.expr, *, alone: bool = False) -> Value:
        """Return what an expression is worth."""

    def text(self, value: Value) -> str:
        """Return a number as C, of its own kind."""
        if isinstance(value, Scalar):
            return value.code
        kind = kind_of(value)
        assert isinstance(value, Constant)
        assert kind is not None
        if kind == REAL:
            return self.dialect.number(value.value)
        return str(value.value).lower() if kind == BOOL else str(value.value)

    def converted(self, value: Value, kind: str, node: ast.AST) -> str:
        """Return a number as C, of the kind that is asked for."""
        own = kind_of(value)
        if own is None:
            raise self.source.refuse(node, f"{type(value).__name__.lower()} where a number is due")
        if own == kind:
            return self.text(value)
        if isinstance(value, Constant) and kind == REAL:
            return self.dialect.number(float(value.value))
        if isinstance(value, Constant) and own == INT and kind == LONG:
            return self.text(value)
        if isinstance(value, Scalar) and kind == REAL:
            if own == BOOL:
                one, zero = self.dialect.number(1.0), self.dialect.number(0.0)
                return f"({value.code} ? {one} : {zero})"
            return f"({self.dialect.real}){value.within(UNARY)}"
        if kind == LONG and own == INT:
            return self.text(value)
        raise self.source.refuse(
            node, f"{own} becomes {kind}: let a name be a real from the start (0.0), or never"
        )

    def returned_kind(self, kind: str | None, node: ast.AST) -> str:
        """Return the kind of what is returned."""
        if kind is None:
            raise self.source.refuse(node, "returns what is no number")
        return kind

    def member(self, owner: Rows, name: str) -> Value:
        """Return a named row."""
        shape = owner.struct.fields[name]
        if isinstance(shape, Constant):
            return shape
        owner.struct.used.add(name)
        self.written = owner.root
        code = owner.code
        held = f"({code})" if code.startswith("&") else code
        code = f"{held}->{member_name(name)}"
        return Array(code, shape, owner.root) if shape else Scalar(REAL, code)

    def pointer(self, array: Array) -> str:
        """Return a pointer to the first entry."""
        if array.offset is None:
            return array.code
        if isinstance(array.offset, Constant):
            return f"{array.code} + {array.offset.value}"
        return f"{array.code} + {array.offset.within(PLUS + 1)}"

    def entry(self, array: Array, indices: Sequence[Value], node: ast.AST) -> str:
        """Return an entry as C."""
        found = self._at(array, indices, node)
        if found.shape:
            raise self.source.refuse(node, "a row where a number is due")
        offset = found.offset or Constant(0)
        return f"{found.code}[{self.text(offset)}]"

    def part(self, array: Array, index: int) -> Value:
        """Return one of the values of the first index."""
        found = self._at(array, [Constant(index)], self.source.tree)
        if found.shape:
            return found
        self.written = array.root
        return Scalar(REAL, f"{found.code}[{self.text(found.offset or Constant(0))}]")

    def subscript(self, node: ast.Subscript) -> Value:
        """Return an entry, a row, or what follows a place."""
        owner = self.value(node.value)
        if isinstance(owner, Constant | Many) and not isinstance(node.slice, ast.Slice):
            index = self.value(node.slice)
            items = owner.items if isinstance(owner, Many) else owner.value
            if not isinstance(index, Constant) or not isinstance(items, tuple):
                raise self.source.refuse(node, "a place in a tuple that is not known beforehand")
            item = items[index.value]
            return item if isinstance(owner, Many) else Constant(item)
        if not isinstance(owner, Array):
            raise self.source.refuse(node, f"{ast.unparse(node)} has no translation")
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if any(isinstance(part, ast.Slice) for part in parts[:-1]):
            raise self.source.refuse(node, "a column of a table")
        last = parts[-1]
        if isinstance(last, ast.Slice):
            row = self._at(owner, [self.value(part) for part in parts[:-1]], node)
            return self._tail(node, row, last)
        found = self._at(owner, [self.value(part) for part in parts], node)
        self.written = owner.root
        if found.shape:
            return found
        if found.data is not None and isinstance(found.offset, Constant | None):
            return Constant(float(found.data.flat[found.offset.value if found.offset else 0]), True)
        return Scalar(REAL, f"{found.code}[{self.text(found.offset or Constant(0))}]")

    def _tail(self, node: ast.AST, array: Array, part: ast.Slice) -> Array:
        bounds = [None if b is None else self.value(b) for b in (part.lower, part.upper)]
        if part.step is not None or not all(b is None or isinstance(b, Constant) for b in bounds):
            raise self.source.refuse(node, "a part whose bounds are not known beforehand")
        given = [b.value if isinstance(b, Constant) else None for b in bounds]
        start, stop, _ = slice(*given).indices(array.shape[0])
        offset = self._sum(array.offset, Constant(start * array.stride))
        return replace(array, shape=(max(stop - start, 0), *array.shape[1:]), offset=offset)

    def _at(self, array: Array, indices: Sequence[Value], node: ast.AST) -> Array:
        if len(indices) > len(array.shape):
            raise self.source.refuse(node, f"{len(indices)} indices of {len(array.shape)}")
        offset, shape = array.offset, array.shape
        for index in indices:
            if kind_of(index) not in (INT, LONG):
                raise self.source.refuse(node, "an index that is no whole number")
            size, shape = shape[0], shape[1:]
            stride = 1
            for more in shape:
                stride *= more
            if isinstance(index, Constant):
                if not -size <= index.value < size:
                    raise self.source.refuse(node, f"index {index.value} of {size} entries")
                offset = self._sum(offset, Constant(index.value % size * stride))
            else:
                assert isinstance(index, Scalar)
                step = index
                if stride != 1:
                    step = Scalar(index.kind, f"{index.within(TIMES)} * {stride}", TIMES)
                offset = self._sum(offset, step)
        return replace(array, shape=shape, offset=offset)

    def _sum(self, a: Scalar | Constant | None, b: Scalar | Constant) -> Scalar | Constant | None:
        if isinstance(b, Constant) and b.value == 0:
            return a
        if a is None or (isinstance(a, Constant) and a.value == 0):
            return b
        if isinstance(a, Constant) and isinstance(b, Constant):
            return Constant(a.value + b.value)
        kinds = {kind_of(a), kind_of(b)}
        code = f"{self.text(a)} + {self.text(b)}"
        return Scalar(LONG if LONG in kinds else INT, code, PLUS)
