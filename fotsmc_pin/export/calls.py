"""Calls of a kernel as C: of other kernels, of `math`, and of the few functions of Python's own."""

from __future__ import annotations

import ast
import builtins
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.compiled import is_kernel
from fotsmc_pin.control.rows import named_rows, row_names, rows
from fotsmc_pin.export.dialect import MATH
from fotsmc_pin.export.memory import Memory
from fotsmc_pin.export.values import (
    BOOL,
    INT,
    LONG,
    PRIMARY,
    REAL,
    Array,
    Constant,
    Many,
    Root,
    Rows,
    Scalar,
    Struct,
    Table,
    kind_of,
)

if TYPE_CHECKING:
    from fotsmc_pin.export.values import Value

SAME_IN_NUMPY = {
    getattr(np, name): name
    for name in ("exp", "sqrt", "tanh", "sin", "cos", "tan", "log", "copysign", "hypot", "expm1")
}
TESTS = {math.isfinite: "isfinite", math.isnan: "isnan", math.isinf: "isinf"}


class Calls(Memory):
    """Translates calls."""

    def call(self, node: ast.Call, *, alone: bool) -> Value | None:
        """Return what a call is worth; None where it returns nothing."""
        if isinstance(node.func, ast.Attribute):
            method = self._method(node)
            if method is not None:
                return method
        called = self.value(node.func)
        if not isinstance(called, Constant):
            raise self.source.refuse(node, f"{ast.unparse(node.func)} is no function")
        function = called.value
        if node.keywords:
            raise self.source.refuse(node, "arguments by name")
        if function in (rows, named_rows):
            return self._named_rows(node, function)
        if function in (np.zeros, np.empty):
            return self._local_array(node)
        values = [self.value(argument) for argument in node.args]
        if is_kernel(function):
            return self._kernel(node, function, values, alone)
        return self._library(node, function, values)

    def _kernel(
        self, node: ast.Call, kernel: Any, values: list[Value], alone: bool
    ) -> Value | None:
        if any(isinstance(value, Many) for value in values):
            raise self.source.refuse(node, "a tuple as an argument")
        made = self.program.function(kernel, values, caller=self.source, node=node)
        if made.always is not None:
            return made.always
        if made.writes and not alone:
            raise self.source.refuse(
                node, f"{made.name} writes to arrays inside an expression: assign its result first"
            )
        given = []
        for k in made.kept:
            value, inside = values[k], made.arguments[k][1]
            if isinstance(inside, Scalar):
                given.append(self.converted(value, inside.kind, node))
                continue
            assert isinstance(inside, Array | Rows | Table)
            assert isinstance(value, Array | Rows | Table)
            if inside.root.written:
                value.root.write()
            given.append(self.pointer(value) if isinstance(value, Array) else value.code)
        code = f"{made.name}({', '.join(given)})"
        if made.result is None:
            self.emit(f"{code};")
            return None
        if isinstance(made.result, tuple):
            name = self.temporary()
            self.emit(f"const {self.program.tuple_type(made.result)} {name} = {code};")
            items = enumerate(made.result)
            return Many(tuple(Scalar(kind, f"{name}.r{k}") for k, kind in items))
        return Scalar(made.result, code)

    def _library(self, node: ast.Call, function: Any, values: list[Value]) -> Value:
        if any(kind_of(value) is None for value in values):
            raise self.source.refuse(node, f"{ast.unparse(node.func)} has no translation")
        if all(isinstance(value, Constant) for value in values):
            known = [value.value for value in values if isinstance(value, Constant)]
            if function in (abs, min, max, int, float, bool) or function in _functions_of_math():
                try:
                    return Constant(function(*known))
                except (ArithmeticError, ValueError, TypeError) as error:
                    raise self.source.refuse(node, f"{ast.unparse(node)}: {error}") from None
        if function in TESTS:
            argument = self.converted(values[0], REAL, node)
            return Scalar(BOOL, f"{TESTS[function]}({argument})")
        if function in (min, max) and len(values) >= 2:
            return self._extreme(node, function, values)
        if function in (abs, np.abs) and len(values) == 1:
            if kind_of(values[0]) != REAL:
                raise self.source.refuse(node, "abs of what is no real")
            return Scalar(REAL, f"{self.dialect.function('fabs')}({self.text(values[0])})")
        if function in (float, bool, int) and len(values) == 1:
            return self._cast(node, function, values[0])
        name = _functions_of_math().get(function) or SAME_IN_NUMPY.get(function)
        if name is None:
            raise self.source.refuse(
                node, f"{ast.unparse(node.func)} has no translation; is it a function with @kernel?"
            )
        given = ", ".join(self.converted(value, REAL, node) for value in values)
        return Scalar(REAL, f"{self.dialect.function(MATH.get(name) or name)}({given})")

    def _extreme(self, node: ast.Call, function: Any, values: list[Value]) -> Value:
        kinds = {kind_of(value) for value in values}
        if REAL not in kinds:
            raise self.source.refuse(node, "min and max of whole numbers")
        name = self.program.helper("least" if function is builtins.min else "greatest")
        code = self.converted(values[0], REAL, node)
        for value in values[1:]:
            code = f"{name}({code}, {self.converted(value, REAL, node)})"
        return Scalar(REAL, code)

    def _cast(self, node: ast.Call, function: Any, value: Value) -> Value:
        if function is float:
            return Scalar(REAL, self.converted(value, REAL, node), PRIMARY)
        if function is bool:
            return self.truth(value, node)
        if kind_of(value) in (INT, LONG):
            return value
        return Scalar(LONG, f"{self.program.helper('whole')}({self.converted(value, REAL, node)})")

    def truth(self, value: Value, node: ast.AST) -> Value:
        """Return whether a number is not zero."""
        if isinstance(value, Constant):
            return Constant(bool(value.value))
        if not isinstance(value, Scalar):
            raise self.source.refuse(node, "bool of what is no number")
        if value.kind == BOOL:
            return value
        zero = self.dialect.number(0.0) if value.kind == REAL else "0"
        return Scalar(BOOL, f"({value.within(10)} != {zero})")

    def _method(self, node: ast.Call) -> Value | None:
        """Return the largest or least entry of a vector, the methods that are known."""
        assert isinstance(node.func, ast.Attribute)
        owner = self.value(node.func.value)
        if not isinstance(owner, Array):
            return None
        name = {"max": "greatest", "min": "least"}.get(node.func.attr)
        if name is None or node.args or len(owner.shape) != 1 or not owner.shape[0]:
            raise self.source.refuse(node, f"{ast.unparse(node.func)} has no translation")
        code = self.entry(owner, [Constant(0)], node)
        for k in range(1, owner.shape[0]):
            entry = self.entry(owner, [Constant(k)], node)
            code = f"{self.program.helper(name)}({code}, {entry})"
        return Scalar(REAL, code)

    def _named_rows(self, node: ast.Call, function: Any) -> Value:
        table, *kinds = [self.value(argument) for argument in node.args]
        if not isinstance(table, Table):
            raise self.source.refuse(node, "the rows of what is no table of the law")
        given = [row_names(kind.value) for kind in kinds if isinstance(kind, Constant)]
        found = list(table.groups)
        if function is named_rows:
            return self._group(node, table, found, given[0])
        own = [self._group(node, table, found, found[0][1].kind)]
        return Many((*own, *(self._group(node, table, found[1:], kind) for kind in given)))

    def _group(
        self, node: ast.Call, table: Table, groups: list[tuple[str, Struct]], names: Any
    ) -> Rows:
        """Return the rows of these names; where there are none, any will do."""
        for member, struct in groups:
            if struct.kind is names:
                code = f"&{table.code}->{member}" if member else table.code
                return Rows(code, struct, table.root)
        if not names._fields:
            return Rows(table.code, Struct("void", names, {}), table.root)
        raise self.source.refuse(node, "rows other than those that the law declares")

    def _local_array(self, node: ast.Call) -> Value:
        size = self.value(node.args[0])
        shape = size.value if isinstance(size, Constant) else None
        shape = (shape,) if isinstance(shape, int) else shape
        if not isinstance(shape, tuple) or not 1 <= len(shape) <= 3 or len(node.args) != 1:
            raise self.source.refuse(node, "an array whose size is not known beforehand")
        name = self.temporary("space")
        zero = self.dialect.number(0.0)
        entries = max(1, math.prod(shape))
        self.emit(f"{self.dialect.real} {name}[{entries}] = {{{zero}}};", name)
        return Array(name, shape, Root())


def _functions_of_math() -> dict[Any, str]:
    found = {getattr(math, name): name for name in MATH if hasattr(math, name)}
    return found | {pow: "pow"}
