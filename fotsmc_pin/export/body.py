"""The statements of a kernel as C."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.export.dialect import comment, identifier
from fotsmc_pin.export.expression import Expressions
from fotsmc_pin.export.values import (
    BOOL,
    INT,
    LONG,
    REAL,
    Array,
    Constant,
    Many,
    Root,
    Rows,
    Scalar,
    kind_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from fotsmc_pin.export.program import Program
    from fotsmc_pin.export.source import Source
    from fotsmc_pin.export.values import Value


@dataclass
class Line:
    """A line of C, with what it declares, or a comment.

    Attributes:
        write: gives the text once everything is known.
        declares: the variable that can be left out where nothing reads it.
        is_comment: whether it says nothing to the compiler.
    """

    write: Callable[[], str]
    declares: str | None = None
    is_comment: bool = False


class Body(Expressions):
    """Translates the statements of one function.

    Attributes:
        result: kind of what it returns, kinds of several, or None.
        code_lines: the lines without comments.
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
        self.code_lines: list[str] = []
        self._lines: list[Line] = []
        self._hoisted: list[Line] = []
        self._indent = 1
        self._declared: list[set[str]] = [set()]
        self._loops: list[str] = []
        self._commented = source.tree.body[0].lineno - 1
        self._temporaries = 0
        for name, constant in known.items():
            if name in source.stored:  # an argument that is known, and then changed
                self._declare_variable(name, constant, hoisted=False)

    def translated(self) -> list[str]:
        """Return the lines between the braces."""
        statements = self.source.tree.body
        if isinstance(statements[0], ast.Expr) and isinstance(statements[0].value, ast.Constant):
            self._commented = statements[0].end_lineno or statements[0].lineno
            statements = statements[1:]
        ends = self._block(statements)
        if self.result is not None and not ends:
            raise self.source.refuse(self.source.tree, "a way to the end without `return`")
        lines = [*self._hoisted, *self._lines]
        while True:  # What nothing reads is left out; and what only that has read.
            texts = [line.write() for line in lines]
            code = "\n".join(t for t, ln in zip(texts, lines, strict=True) if not ln.is_comment)
            kept = [
                line
                for line in lines
                if line.declares is None or len(re.findall(rf"\b{line.declares}\b", code)) > 1
            ]
            if len(kept) == len(lines):
                self.code_lines = code.splitlines()
                return texts
            lines = kept

    def _emit(self, text: str | Callable[[], str], declares: str | None = None) -> None:
        indent = "    " * self._indent
        write = text if callable(text) else lambda: text
        self._lines.append(Line(lambda: indent + write(), declares))

    def _block(self, statements: list[ast.stmt]) -> bool:
        """Translate statements; return whether they end with a way out."""
        for statement in statements:
            self._comment_until(statement.lineno)
            if self._statement(statement):
                return True
        return False

    def _comment_until(self, line: int) -> None:
        found = [self.source.comments[k] for k in range(self._commented + 1, line) if k in self.source.comments]
        self._commented = max(self._commented, line)
        if found:
            for text in comment("\n".join(found), "    " * self._indent):
                self._lines.append(Line(lambda text=text: text, is_comment=True))  # type: ignore[misc]

    def _nested(self, head: str, statements: list[ast.stmt], declares: str | None = None) -> bool:
        self._emit(head)
        self._indent += 1
        self._declared.append({declares} if declares else set())
        ends = self._block(statements)
        self._declared.pop()
        self._indent -= 1
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
                    self._emit(f"(void){made.within(14)};")
                elif isinstance(made, Many):
                    raise self.source.refuse(node, "results that are not taken")
                return False
            case ast.Assign(targets, value):
                self._assign(node, targets, value)
                return False
            case ast.AnnAssign(target, _, value) if value is not None:
                self._assign(node, [target], value)
                return False
            case ast.AugAssign():
                self._augment(node)
                return False
            case ast.If():
                return self._if(node)
            case ast.For():
                return self._for(node)
            case ast.While() if not node.orelse:
                condition = self.condition(node.test, alone=True)
                if isinstance(condition, Constant) and not condition.value:
                    return False
                self._loops.append("")
                self._nested(f"while ({self.text(condition)}) {{", node.body)
                self._loops.pop()
                self._emit("}")
                return False
            case ast.Break() | ast.Continue():
                self._emit("break;" if isinstance(node, ast.Break) else "continue;")
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
        ends = self._nested(f"if ({condition.code}) {{", node.body)
        orelse = node.orelse
        while len(orelse) == 1 and isinstance(orelse[0], ast.If):
            inner = orelse[0]
            condition = self.condition(inner.test, alone=True)
            if isinstance(condition, Constant):
                orelse = inner.body if condition.value else inner.orelse
                continue
            self._comment_until(inner.lineno)
            ends = self._nested(f"}} else if ({condition.code}) {{", inner.body) and ends
            orelse = inner.orelse
        if orelse:
            ends = self._nested("} else {", orelse) and ends
        self._emit("}")
        return ends and bool(orelse)

    def _for(self, node: ast.For) -> bool:
        if not isinstance(node.target, ast.Name) or node.orelse:
            raise self.source.refuse(node, "`for` with several targets or with `else`")
        name, loops = node.target.id, self._loops
        inside = {id(n) for n in ast.walk(node)}
        if name in loops or any(
            isinstance(n, ast.Name) and n.id == name and isinstance(n.ctx, ast.Store)
            for statement in node.body
            for n in ast.walk(statement)
        ):
            raise self.source.refuse(node, f"{name}, which counts the loop, is assigned in it")
        for other in ast.walk(self.source.tree):
            if isinstance(other, ast.Name) and other.id == name and id(other) not in inside:
                if not self._counts_elsewhere(other, name):
                    raise self.source.refuse(other, f"{name} is used outside the loop over it")
        before = self.environment.get(name)
        counted = self._range(node)
        if counted is not None:
            head, kind = counted
            self.environment[name] = Scalar(kind, identifier(name))
            self._loops.append(name)
            self._nested(head, node.body, identifier(name))
            self._loops.pop()
            self._emit("}")
        if before is not None:
            self.environment[name] = before
        return False

    def _counts_elsewhere(self, other: ast.Name, name: str) -> bool:
        return any(
            isinstance(loop, ast.For)
            and isinstance(loop.target, ast.Name)
            and loop.target.id == name
            and any(n is other for n in ast.walk(loop))
            for loop in ast.walk(self.source.tree)
        )

    def _range(self, node: ast.For) -> tuple[str, str] | None:
        """Return the head of a loop and the kind of its counter; None where it never runs."""
        name = identifier(node.target.id)  # type: ignore[attr-defined]
        call = node.iter
        is_range = (
            isinstance(call, ast.Call)
            and isinstance(call.func, ast.Name)
            and self.source.scope.get(call.func.id) is range
        )
        if not is_range:
            over = self.value(call)
            if not isinstance(over, Array) or len(over.shape) != 1:
                raise self.source.refuse(node, "`for` over anything but `range` or a vector")
            if over.shape[0] == 0:
                return None
            place = f"place_of_{name}"
            entry = self.entry(over, [Scalar(INT, place)], node)
            head = f"for (int {place} = 0; {place} < {over.shape[0]}; {place}++) {{"
            body = f"    const {self.dialect.real} {name} = {entry};"
            return f"{head}\n{'    ' * self._indent}{body}", REAL
        assert isinstance(call, ast.Call)
        bounds = [self.value(argument) for argument in call.args]
        if any(kind_of(b) not in (INT, LONG) for b in bounds) or not 1 <= len(bounds) <= 3:
            raise self.source.refuse(node, "`range` over what are no whole numbers")
        step = bounds[2].value if len(bounds) == 3 and isinstance(bounds[2], Constant) else 1
        if (len(bounds) == 3 and not isinstance(bounds[2], Constant)) or step == 0:
            raise self.source.refuse(node, "`range` with a step that is not known beforehand")
        start, stop = (Constant(0), bounds[0]) if len(bounds) == 1 else bounds[:2]
        if isinstance(start, Constant) and isinstance(stop, Constant):
            if not len(range(start.value, stop.value, step)):
                return None
        elif not isinstance(stop, Constant):
            end = self.temporary()
            self._emit(f"const {self.dialect.type_of(kind_of(stop) or INT)} {end} = {self.text(stop)};")
            stop = Scalar(kind_of(stop) or INT, end)
        kind = LONG if LONG in (kind_of(start), kind_of(stop)) else INT
        compare, move = ("<", "++") if step > 0 else (">", "--")
        move = move if abs(step) == 1 else f" {'+' if step > 0 else '-'}= {abs(step)}"
        return (
            f"for ({self.dialect.type_of(kind)} {name} = {self.text(start)}; "
            f"{name} {compare} {self.text(stop)}; {name}{move}) {{"
        ), kind

    def _return(self, node: ast.Return) -> None:
        if node.value is None:
            if self.result is not None:
                raise self.source.refuse(node, "`return` with and without a value")
            self._emit("return;")
            return
        value = _as_many(self.value(node.value, alone=True))
        items = value.items if isinstance(value, Many) else (value,)
        kinds = tuple(self.returned_kind(kind_of(item), node) for item in items)
        found = kinds if isinstance(value, Many) else kinds[0]
        if isinstance(self.result, tuple) and isinstance(found, tuple):
            found = tuple(REAL if REAL in pair else pair[0] for pair in zip(self.result, found, strict=True))
        if self.result not in (None, found):
            raise self.source.refuse(node, f"returns {found} here and {self.result} elsewhere")
        self.result = found
        if isinstance(found, tuple):
            # Kinds are those of all returns together, known at the end.
            def text() -> str:
                assert isinstance(self.result, tuple)
                results = zip(items, self.result, strict=True)
                parts = ", ".join(self.converted(item, kind, node) for item, kind in results)
                name = self.temporary_of(node)
                return f"{{ const {self.program.tuple_type(self.result)} {name} = {{{parts}}}; return {name}; }}"

            self._emit(text)
            return
        self._emit(f"return {self.converted(value, kinds[0], node)};")

    def _augment(self, node: ast.AugAssign) -> None:
        loaded = ast.copy_location(_loaded(node.target), node.target)
        both = ast.copy_location(ast.BinOp(loaded, node.op, node.value), node)
        simple = {ast.Add: "+=", ast.Sub: "-=", ast.Mult: "*=", ast.Div: "/="}.get(type(node.op))
        target = self.target(node.target, kind_of(self.value(both)))
        if simple and kind_of(target) == REAL:
            value = self.converted(self.value(node.value, alone=True), REAL, node)
            self._emit(f"{self.text(target)} {simple} {value};")
        else:
            value = self.converted(self.value(both), kind_of(target) or REAL, node)
            self._emit(f"{self.text(target)} = {value};")

    def target(self, node: ast.expr, kind: str | None) -> Scalar:
        """Return what is assigned, and remember that its memory is written."""
        if isinstance(node, ast.Name):
            found = self.environment.get(node.id)
            if not isinstance(found, Scalar) or node.id in self._loops:
                raise self.source.refuse(node, f"{node.id} cannot be changed")
            return found
        found = self.value(node)
        array = self.written
        if not isinstance(found, Scalar) or array is None:
            raise self.source.refuse(node, "an assignment to this")
        array.write()
        return found

    def _assign(self, node: ast.stmt, targets: list[ast.expr], value: ast.expr) -> None:
        if len(targets) == 1 and isinstance(targets[0], ast.Subscript) and self._fills(targets[0], value):
            return
        if len(targets) == 1 and isinstance(targets[0], ast.Tuple):
            self._unpack(node, targets[0].elts, value)
            return
        found = self.value(value, alone=True)
        if len(targets) > 1 and not isinstance(found, Constant):
            name = self.temporary()
            kind = kind_of(found)
            if kind is None:
                raise self.source.refuse(node, "one array under two names")
            self._emit(f"const {self.dialect.type_of(kind)} {name} = {self.text(found)};")
            found = Scalar(kind, name)
        for target in reversed(targets) if len(targets) > 1 else targets:
            self._store(target, found, node)

    def _fills(self, target: ast.Subscript, value: ast.expr) -> bool:
        """Translate `array[:] = number`; return whether it was that."""
        if not (isinstance(target.slice, ast.Slice) and ast.unparse(target.slice) == ":"):
            return False
        array, number = self.value(target.value), self.value(value)
        if not isinstance(array, Array) or kind_of(number) is None:
            raise self.source.refuse(target, "an assignment of an array to a part of another")
        array.root.write()
        place, size = "entry", array.stride * array.shape[0]
        self._emit(f"for (int {place} = 0; {place} < {size}; {place}++) {{")
        flat = Array(array.code, (size,), array.root, array.offset)
        entry = self.entry(flat, [Scalar(INT, place)], target)
        self._emit(f"    {entry} = {self.converted(number, REAL, target)};")
        self._emit("}")
        return True

    def _unpack(self, node: ast.stmt, targets: list[ast.expr], value: ast.expr) -> None:
        if isinstance(value, ast.Tuple):
            found = [self.value(item, alone=True) for item in value.elts]
            found = self._settled(targets, value.elts, found)
        else:
            many = _as_many(self.value(value, alone=True))
            if isinstance(many, Array):
                many = Many(tuple(self.part(many, k) for k in range(many.shape[0])))
            if not isinstance(many, Many):
                raise self.source.refuse(node, "several names for what are not several values")
            found = list(many.items)
        if len(found) != len(targets):
            raise self.source.refuse(node, f"{len(targets)} names for {len(found)} values")
        for target, item in zip(targets, found, strict=True):
            self._store(target, item, node)

    def _settled(
        self, targets: list[ast.expr], sources: list[ast.expr], found: list[Value]
    ) -> list[Value]:
        """Put values aside that an assignment before their own might change."""
        settled = []
        for k, (value, source) in enumerate(zip(found, sources, strict=True)):
            parts = list(ast.walk(source))
            read = {n.id for n in parts if isinstance(n, ast.Name)}
            entries = {_row(n) for n in parts if isinstance(n, ast.Subscript)}
            before = targets[:k]
            clash = any(isinstance(t, ast.Name) and t.id in read for t in before)
            for row in (_row(t) for t in before if isinstance(t, ast.Subscript)):
                clash |= row in entries or bool(entries and None in (row, *entries))
            if clash and isinstance(value, Scalar):
                name = self.temporary()
                self._emit(f"const {self.dialect.type_of(value.kind)} {name} = {value.code};")
                value = Scalar(value.kind, name)
            settled.append(value)
        return settled

    def _store(self, target: ast.expr, value: Value, node: ast.stmt) -> None:
        if isinstance(target, ast.Name):
            self._name(target, value, node)
        elif isinstance(target, ast.Subscript | ast.Attribute):
            place = self.target(target, kind_of(value))
            self._emit(f"{place.code} = {self.converted(value, place.kind, node)};")
        else:
            raise self.source.refuse(node, f"an assignment to {type(target).__name__}")

    def _name(self, target: ast.Name, value: Value, node: ast.stmt) -> None:
        name = target.id
        if name == "_":
            return
        once = self.source.stored[name] == 1
        if kind_of(value) is not None and not (once and isinstance(value, Constant)):
            held = self.environment.get(name)
            if held is None or not isinstance(held, Scalar):
                self._declare_variable(name, value, hoisted=not self._is_first(name, target))
            else:
                self._emit(f"{held.code} = {self.converted(value, held.kind, node)};")
            return
        if name in self.environment and not isinstance(value, Array):
            raise self.source.refuse(node, f"{name} means something else before")
        if isinstance(value, Array):
            self._name_array(name, value, node, once)
        elif isinstance(value, Rows):
            self._name_rows(name, value)
        else:
            self.environment[name] = value

    def _is_first(self, name: str, target: ast.Name) -> bool:
        """Whether this assignment stands before and around every use of the name."""
        places = self.source.places[name]
        shared = places[0]
        for place in places:
            shared = tuple(a for a, b in zip(shared, place, strict=False) if a[0] == b[0])
        depth = len(shared) - 1
        first = min(place[depth][1] for place in places)
        firsts = [place for place in places if place[depth][1] == first]
        return all(len(place) == depth + 1 for place in firsts) and any(
            place[depth][1] == first for place in firsts
        ) and self._starts_with_store(name, target)

    def _starts_with_store(self, name: str, target: ast.Name) -> bool:
        for n in ast.walk(self.source.tree):
            if isinstance(n, ast.Name) and n.id == name and n is not target:
                before = (n.lineno, n.col_offset) < (target.lineno, target.col_offset)
                if before and isinstance(n.ctx, ast.Store):
                    return False
        return True

    def _declare_variable(self, name: str, value: Value, *, hoisted: bool) -> None:
        kind, c_name = kind_of(value), identifier(name)
        assert kind is not None
        self.environment[name] = Scalar(kind, c_name)
        type_name = self.dialect.type_of(kind)
        text = self.converted(value, kind, self.source.tree)
        if hoisted:
            zero = {REAL: self.dialect.number(0.0), BOOL: "false"}.get(kind, "0")
            self._hoisted.append(Line(lambda: f"    {type_name} {c_name} = {zero};", None))
            self._emit(f"{c_name} = {text};")
            return
        fixed = self.source.stored.get(name, 0) <= 1 and not self._is_known_argument(name)
        self._emit(f"{'const ' if fixed else ''}{type_name} {c_name} = {text};", c_name)

    def _is_known_argument(self, name: str) -> bool:
        return name in self.source.function.__code__.co_varnames[: self.source.function.__code__.co_argcount]

    def _name_array(self, name: str, value: Array, node: ast.stmt, once: bool) -> None:
        c_name, held = identifier(name), self.environment.get(name)
        text = self.pointer(value)
        if held is None or (isinstance(held, Array) and held.shape == value.shape and not self._in_scope(c_name)):
            root = Root(views=value.root)
            self._declared[-1].add(c_name)
            real, fixed = self.dialect.real, " const" if once else ""
            self._emit(
                lambda: f"{'' if root.written else 'const '}{real} *{fixed}{c_name} = {text};".replace("* const", "*const "),
                c_name,
            )
            self.environment[name] = Array(c_name, value.shape, root)
        else:
            raise self.source.refuse(node, f"{name} is two arrays in turn: give each a name")

    def _in_scope(self, c_name: str) -> bool:
        return any(c_name in names for names in self._declared)

    def _name_rows(self, name: str, value: Rows) -> None:
        c_name, root = identifier(name), Root(views=value.root)
        self._emit(
            lambda: f"{'' if root.written else 'const '}{value.struct.name} *const {c_name} = {value.code};",
            c_name,
        )
        self.environment[name] = Rows(c_name, value.struct, root)

    def temporary(self) -> str:
        """Return the name of a variable that no kernel has."""
        self._temporaries += 1
        return f"now_v{self._temporaries}"

    def temporary_of(self, node: ast.AST) -> str:
        """Return the name of the results of a `return`."""
        return "results_v1"


def _as_many(value: Value) -> Value:
    """Return a tuple that is known beforehand as any other tuple."""
    if isinstance(value, Constant) and isinstance(value.value, tuple):
        return Many(tuple(Constant(item) for item in value.value))
    return value


def _loaded(target: ast.expr) -> ast.expr:
    fresh = ast.parse(ast.unparse(target), mode="eval").body
    for n in ast.walk(fresh):
        ast.copy_location(n, target)
    return fresh


def _row(node: ast.Subscript) -> str | None:
    """Return the named row that is indexed; None for memory that may lie in any other."""
    return ast.unparse(node.value) if isinstance(node.value, ast.Attribute) else None
