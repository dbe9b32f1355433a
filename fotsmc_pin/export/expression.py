"""The expressions of a kernel as C."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from fotsmc_pin.export.calls import Calls
from fotsmc_pin.export.operators import ARITHMETIC, COMPARISON, FOLDED, without_zero
from fotsmc_pin.export.values import (
    AND,
    BOOL,
    EQUAL,
    INT,
    LONG,
    OR,
    REAL,
    TERNARY,
    UNARY,
    Array,
    Constant,
    Many,
    Rows,
    Scalar,
    Table,
    kind_of,
)

if TYPE_CHECKING:
    from fotsmc_pin.export.values import Value


class Expressions(Calls):
    """Translates expressions; arithmetic keeps the order of Python's operations."""

    def value(self, node: ast.expr, *, alone: bool = False) -> Value:
        """Return what an expression is worth.

        Args:
            node: the expression.
            alone: whether it is all that a statement evaluates, so that it may call what writes.
        """
        self.written = None
        match node:
            case ast.Constant(known) if known is None or isinstance(
                known, bool | int | float | str
            ):
                return Constant(known)
            case ast.Name(name):
                return self._named(node, name)
            case ast.Attribute():
                return self._attribute(node)
            case ast.Subscript():
                return self.subscript(node)
            case ast.Tuple(items):
                return self._tuple(items)
            case ast.BinOp():
                return self._arithmetic(node)
            case ast.UnaryOp():
                return self._unary(node, alone)
            case ast.BoolOp():
                return self._logic(node)
            case ast.Compare():
                return self._comparison(node)
            case ast.IfExp():
                return self._choice(node)
            case ast.Call():
                result = self.call(node, alone=alone)
                if result is None:
                    raise self.source.refuse(node, f"{ast.unparse(node)} returns nothing")
                return result
            case _:
                raise self.source.refuse(node, f"{type(node).__name__} has no translation")

    def condition(self, node: ast.expr, *, alone: bool = False) -> Constant | Scalar:
        """Return whether an expression is true."""
        value = self.value(node, alone=alone)
        if isinstance(value, Constant):
            return Constant(bool(value.value))
        if not isinstance(value, Scalar):
            raise self.source.refuse(node, "a condition that is no number")
        if value.kind == BOOL:
            return value
        zero = self.dialect.number(0.0) if value.kind == REAL else "0"
        return Scalar(BOOL, f"{value.within(EQUAL + 1)} != {zero}", EQUAL)

    def _named(self, node: ast.expr, name: str) -> Value:
        if name in self.environment:
            return self.environment[name]
        if name in self.source.stored:
            raise self.source.refuse(node, f"{name} is used before it is assigned")
        if name in self.source.scope:
            return Constant(self.source.scope[name])
        raise self.source.refuse(node, f"{name} is not known")

    def _tuple(self, items: list[ast.expr]) -> Value:
        values = tuple(self.value(item) for item in items)
        known = [value.value for value in values if isinstance(value, Constant)]
        return Constant(tuple(known)) if len(known) == len(values) else Many(values)

    def _attribute(self, node: ast.Attribute) -> Value:
        owner = self.value(node.value)
        name = node.attr
        if isinstance(owner, Constant):
            try:
                return Constant(getattr(owner.value, name))
            except AttributeError:
                raise self.source.refuse(node, f"{ast.unparse(node)} is not known") from None
        if isinstance(owner, Array) and name == "size":
            return Constant(owner.stride * owner.shape[0])
        if isinstance(owner, Array | Table) and name == "shape":
            return Constant(owner.shape)
        if isinstance(owner, Array) and name == "ndim":
            return Constant(len(owner.shape))
        if isinstance(owner, Rows) and name in owner.struct.fields:
            return self.member(owner, name)
        raise self.source.refuse(node, f"{ast.unparse(node)} has no translation")

    def _unary(self, node: ast.UnaryOp, alone: bool) -> Value:
        if isinstance(node.op, ast.Not):
            condition = self.condition(node.operand, alone=alone)
            if isinstance(condition, Constant):
                return Constant(not condition.value)
            return Scalar(BOOL, f"!{condition.within(UNARY)}", UNARY)
        value = self.value(node.operand)
        if type(node.op) not in FOLDED or kind_of(value) in (None, BOOL):
            raise self.source.refuse(node, f"{type(node.op).__name__} has no translation here")
        if isinstance(value, Constant):
            return Constant(FOLDED[type(node.op)](value.value))
        assert isinstance(value, Scalar)
        sign = "-" if isinstance(node.op, ast.USub) else "+"
        code = value.within(UNARY)
        return Scalar(value.kind, f"{sign}{f'({code})' if code[0] in '+-' else code}", UNARY)

    def _arithmetic(self, node: ast.BinOp) -> Value:
        left, right = self.value(node.left), self.value(node.right)
        kinds = kind_of(left), kind_of(right)
        if None in kinds:
            raise self.source.refuse(node, "arithmetic with whole arrays: write a loop")
        if isinstance(left, Constant) and isinstance(right, Constant):
            try:
                folded = FOLDED[type(node.op)](left.value, right.value)
                return Constant(folded, left.decides or right.decides)
            except (ArithmeticError, KeyError) as error:
                raise self.source.refuse(node, f"{ast.unparse(node)}: {error}") from None
        if isinstance(node.op, ast.Pow):
            return self._power(node, left, right)
        if self.source.rounds_freely and REAL in kinds:
            short = without_zero(node.op, left, right)
            if short is not None:
                return short
        if isinstance(node.op, ast.FloorDiv | ast.Mod):
            if REAL in kinds:
                raise self.source.refuse(node, "// and % of reals")
            name = self.program.helper(
                "floored" if isinstance(node.op, ast.FloorDiv) else "remaining"
            )
            return Scalar(LONG, f"{name}({self.text(left)}, {self.text(right)})")
        if type(node.op) not in ARITHMETIC:
            raise self.source.refuse(node, f"{type(node.op).__name__} has no translation")
        sign, binding = ARITHMETIC[type(node.op)]
        real = REAL in kinds or isinstance(node.op, ast.Div)
        kind = REAL if real else LONG if LONG in kinds else INT
        first = self._operand(left, kind, binding, node)
        second = self._operand(right, kind, binding + 1, node)
        if second.startswith("-"):
            second = f"({second})"
        return Scalar(kind, f"{first} {sign} {second}", binding)

    def _operand(self, value: Value, kind: str, binding: int, node: ast.AST) -> str:
        if isinstance(value, Scalar) and value.kind == kind:
            return value.within(binding)
        return self.converted(value, kind, node)

    def _power(self, node: ast.BinOp, left: Value, right: Value) -> Value:
        base = self.converted(left, REAL, node)
        if isinstance(right, Constant) and isinstance(right.value, int):
            name = {2: "square", 3: "cube"}.get(right.value)
            if name is None:
                raise self.source.refuse(node, "a whole power other than 2 and 3: write 4.0")
            return Scalar(REAL, f"{self.program.helper(name)}({base})")
        power = self.converted(right, REAL, node)
        return Scalar(REAL, f"{self.dialect.function('pow')}({base}, {power})")

    def _logic(self, node: ast.BoolOp) -> Value:
        stops = isinstance(node.op, ast.Or)
        parts: list[Scalar] = []
        for operand in node.values:
            found = self.condition(operand)
            if isinstance(found, Scalar):
                parts.append(found)
            elif bool(found.value) is stops:
                if not parts:
                    return Constant(stops)
                parts.append(Scalar(BOOL, "true" if stops else "false"))
                break
        if not parts:
            return Constant(not stops)
        sign, binding = ("||", OR) if stops else ("&&", AND)
        # Compilers ask for parentheses around && within ||.
        inner = [part.within(EQUAL if len(parts) > 1 else binding) for part in parts]
        return Scalar(
            BOOL, f" {sign} ".join(inner), binding if len(parts) > 1 else parts[0].binding
        )

    def _comparison(self, node: ast.Compare) -> Value:
        values = [self.value(item) for item in (node.left, *node.comparators)]
        parts: list[Scalar] = []
        for sign, left, right in zip(node.ops, values, values[1:], strict=False):
            found = self._compared(node, sign, left, right)
            if isinstance(found, Constant):
                if not found.value:
                    return Constant(False)
            else:
                parts.append(found)
        if not parts:
            return Constant(True)
        if len(parts) == 1:
            return parts[0]
        return Scalar(BOOL, " && ".join(part.within(EQUAL) for part in parts), AND)

    def _compared(
        self, node: ast.Compare, op: ast.cmpop, left: Value, right: Value
    ) -> Constant | Scalar:
        if isinstance(op, ast.In | ast.NotIn):
            if not isinstance(right, Constant) or not isinstance(right.value, tuple):
                raise self.source.refuse(node, "`in` what is not known beforehand")
            found = [self._compared(node, ast.Eq(), left, Constant(item)) for item in right.value]
            if all(isinstance(item, Constant) for item in found):
                among = any(item.value for item in found if isinstance(item, Constant))
                return Constant(among is isinstance(op, ast.In))
            text = " || ".join(item.within(AND) for item in found if isinstance(item, Scalar))
            if isinstance(op, ast.NotIn):
                return Scalar(BOOL, f"!({text})", UNARY)
            return Scalar(BOOL, text, OR)
        if isinstance(left, Constant) and isinstance(right, Constant):
            if isinstance(op, ast.Is | ast.IsNot):
                return Constant((left.value is right.value) is isinstance(op, ast.Is))
            return Constant(bool(FOLDED[type(op)](left.value, right.value)))
        kinds = kind_of(left), kind_of(right)
        if type(op) not in COMPARISON or None in kinds:
            raise self.source.refuse(node, f"{ast.unparse(node)} has no translation")
        sign, binding = COMPARISON[type(op)]
        kind = REAL if REAL in kinds else LONG if LONG in kinds else INT if INT in kinds else BOOL
        first = self._operand(left, kind, binding + 1, node)
        second = self._operand(right, kind, binding + 1, node)
        return Scalar(BOOL, f"{first} {sign} {second}", binding)

    def _choice(self, node: ast.IfExp) -> Value:
        condition = self.condition(node.test)
        if isinstance(condition, Constant):
            return self.value(node.body if condition.value else node.orelse)
        yes, no = self.value(node.body), self.value(node.orelse)
        kinds = kind_of(yes), kind_of(no)
        if None in kinds:
            raise self.source.refuse(node, "a choice between what are no numbers")
        kind = REAL if REAL in kinds else LONG if LONG in kinds else kinds[0]
        if BOOL in kinds and kinds != (BOOL, BOOL):
            raise self.source.refuse(node, "a choice between a number and a truth value")
        assert kind is not None
        first = self._operand(yes, kind, TERNARY + 1, node)
        second = self._operand(no, kind, TERNARY + 1, node)
        return Scalar(kind, f"{condition.within(TERNARY + 1)} ? {first} : {second}", TERNARY)
