"""The statements of a kernel as C."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from fotsmc_pin.export.assignments import as_many
from fotsmc_pin.export.loops import Loops
from fotsmc_pin.export.values import (
    REAL,
    Constant,
    Many,
    Scalar,
    kind_of,
)

if TYPE_CHECKING:
    from fotsmc_pin.export.program import Program
    from fotsmc_pin.export.source import Source
    from fotsmc_pin.export.values import Value


class Body(Loops):
    """Translates the statements of one function.

    Attributes:
        result: kind of what it returns, kinds of several, or None.
        code: the text without comments.
        always: what it returns, where it does nothing else than return what is known.
    """

    def __init__(
        self,
        program: Program,
        source: Source,
        environment: dict[str, Value],
        known: dict[str, Constant],
    ) -> None:
        super().__init__(program, source)
        self.environment = environment
        self.result: str | tuple[str, ...] | None = None
        self.code = ""
        self.always: Value | None = None
        for name, constant in known.items():
            if name in source.stored:  # an argument that is known, and then changed
                self.declare_variable(name, constant, hoisted=False)

    def translated(self) -> list[str]:
        """Return the lines between the braces."""
        statements = self.source.tree.body
        if isinstance(statements[0], ast.Expr) and isinstance(statements[0].value, ast.Constant):
            self.skip_comments(statements[0].end_lineno or statements[0].lineno)
            statements = statements[1:]
        ends = self._block(statements)
        if self.result is not None and not ends:
            raise self.source.refuse(self.source.tree, "a way to the end without `return`")
        lines, self.code = self.finished()
        return lines

    def _block(self, statements: list[ast.stmt]) -> bool:
        """Translate statements; return whether they end with a way out."""
        for statement in statements:
            self.comment_until(statement.lineno)
            if self._statement(statement):
                return True
        return False

    def nested(
        self,
        head: str,
        statements: list[ast.stmt],
        declares: str | None = None,
        first: str | None = None,
    ) -> bool:
        """Translate a block under its head; return whether it ends with a way out."""
        self.emit(head)
        self.indent += 1
        if first is not None:
            self.emit(first)
        self.scopes.append({declares} if declares else set())
        ends = self._block(statements)
        self.scopes.pop()
        self.indent -= 1
        return ends

    def _statement(self, node: ast.stmt) -> bool:
        match node:
            case ast.Pass():
                return False
            case ast.Expr(ast.Constant()):
                return False
            case ast.Expr(ast.Call() as call):
                made = self.call(call, alone=True)
                if isinstance(made, Scalar):
                    self.emit(f"(void){made.within(14)};")
                elif isinstance(made, Many):
                    raise self.source.refuse(node, "results that are not taken")
                return False
            case ast.Assign(targets, value):
                self.assign(node, targets, value)
                return False
            case ast.AnnAssign(target, _, value) if value is not None:
                self.assign(node, [target], value)
                return False
            case ast.AugAssign():
                self.augment(node)
                return False
            case ast.If():
                return self._if(node)
            case ast.For():
                return self.loop(node)
            case ast.While() if not node.orelse:
                condition = self.condition(node.test, alone=True)
                if isinstance(condition, Constant) and not condition.value:
                    return False
                self.counting.append("")
                self.nested(f"while ({self.text(condition)}) {{", node.body)
                self.counting.pop()
                self.emit("}")
                return False
            case ast.Break() | ast.Continue():
                self.emit("break;" if isinstance(node, ast.Break) else "continue;")
                return True
            case ast.Return():
                self._return(node)
                return True
            case _:
                raise self.source.refuse(node, f"{type(node).__name__} has no translation")

    def _if(self, node: ast.If) -> bool:
        condition = self.condition(node.test, alone=True)
        if isinstance(condition, Constant):
            return self._block(node.body if condition.value else node.orelse)
        ends = self.nested(f"if ({condition.code}) {{", node.body)
        orelse = node.orelse
        while len(orelse) == 1 and isinstance(orelse[0], ast.If):
            inner = orelse[0]
            condition = self.condition(inner.test, alone=True)
            if isinstance(condition, Constant):
                orelse = inner.body if condition.value else inner.orelse
                continue
            self.comment_until(inner.lineno)
            ends = self.nested(f"}} else if ({condition.code}) {{", inner.body) and ends
            orelse = inner.orelse
        if orelse:
            ends = self.nested("} else {", orelse) and ends
        self.emit("}")
        return ends and bool(orelse)

    def _return(self, node: ast.Return) -> None:
        if node.value is None:
            if self.result is not None:
                raise self.source.refuse(node, "`return` with and without a value")
            self.emit("return;")
            return
        value = as_many(self.value(node.value, alone=True))
        items = value.items if isinstance(value, Many) else (value,)
        kinds = tuple(self.returned_kind(kind_of(item), node) for item in items)
        if self.is_empty and all(isinstance(item, Constant) for item in items):
            self.always = value
        found = kinds if isinstance(value, Many) else kinds[0]
        if isinstance(self.result, tuple) and isinstance(found, tuple):
            found = tuple(
                REAL if REAL in pair else pair[0] for pair in zip(self.result, found, strict=True)
            )
        if self.result not in (None, found):
            raise self.source.refuse(node, f"returns {found} here and {self.result} elsewhere")
        self.result = found
        if isinstance(found, tuple):
            # Kinds are those of all returns together, known at the end.
            def text() -> str:
                assert isinstance(self.result, tuple)
                results = zip(items, self.result, strict=True)
                parts = ", ".join(self.converted(item, kind, node) for item, kind in results)
                kind = self.program.tuple_type(self.result)
                return f"{{ const {kind} results_v1 = {{{parts}}}; return results_v1; }}"

            self.emit(text)
            return
        self.emit(f"return {self.converted(value, kinds[0], node)};")
