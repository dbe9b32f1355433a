"""Operators of Python and what C has in their place."""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any

from fotsmc_pin.export.values import EQUAL, LESS, PLUS, REAL, TIMES, Constant, kind_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from fotsmc_pin.export.values import Value

ARITHMETIC: dict[type[ast.operator], tuple[str, int]] = {
    ast.Add: ("+", PLUS),
    ast.Sub: ("-", PLUS),
    ast.Mult: ("*", TIMES),
    ast.Div: ("/", TIMES),
}
FOLDED: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: operator.not_,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
COMPARISON: dict[type[ast.cmpop], tuple[str, int]] = {
    ast.Eq: ("==", EQUAL),
    ast.NotEq: ("!=", EQUAL),
    ast.Lt: ("<", LESS),
    ast.LtE: ("<=", LESS),
    ast.Gt: (">", LESS),
    ast.GtE: (">=", LESS),
}


def without_zero(op: ast.operator, left: Value, right: Value) -> Value | None:
    """Return what a sum or product with zero is worth; None where there is no zero."""
    zeros = [isinstance(x, Constant) and x.value == 0.0 for x in (left, right)]
    if isinstance(op, ast.Mult) and any(zeros):
        return Constant(0.0, True)
    if isinstance(op, ast.Add) and any(zeros):
        other = right if zeros[0] else left
        return other if kind_of(other) == REAL else None
    if isinstance(op, ast.Sub) and zeros[1] and kind_of(left) == REAL:
        return left
    return None
