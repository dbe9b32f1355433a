"""Assignments of a kernel as C: where variables are declared, and the order of what is stored."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from fotsmc_pin.export.dialect import identifier
from fotsmc_pin.export.expression import Expressions
from fotsmc_pin.export.values import (
    BOOL,
    INT,
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
    from fotsmc_pin.export.values import Value


class Assignments(Expressions):
    """Translates assignments."""

    def augment(self, node: ast.AugAssign) -> None:
        """Translate `x += ...` and its like."""
        loaded = ast.copy_location(_loaded(node.target), node.target)
        both = ast.copy_location(ast.BinOp(loaded, node.op, node.value), node)
        simple = {ast.Add: "+=", ast.Sub: "-=", ast.Mult: "*=", ast.Div: "/="}.get(type(node.op))
        target = self.target(node.target, kind_of(self.value(both)))
        if simple and kind_of(target) == REAL:
            value = self.converted(self.value(node.value, alone=True), REAL, node)
            self.emit(f"{self.text(target)} {simple} {value};")
        else:
            value = self.converted(self.value(both), kind_of(target) or REAL, node)
            self.emit(f"{self.text(target)} = {value};")

    def target(self, node: ast.expr, kind: str | None) -> Scalar:
        """Return what is assigned, and remember that its memory is written."""
        if isinstance(node, ast.Name):
            found = self.environment.get(node.id)
            if not isinstance(found, Scalar) or node.id in self.counting:
                raise self.source.refuse(node, f"{node.id} cannot be changed")
            return found
        found = self.value(node)
        array = self.written
        if not isinstance(found, Scalar) or array is None:
            raise self.source.refuse(node, "an assignment to this")
        array.write()
        return found

    def assign(self, node: ast.stmt, targets: list[ast.expr], value: ast.expr) -> None:
        """Translate `x = y = ...`."""
        if (
            len(targets) == 1
            and isinstance(targets[0], ast.Subscript)
            and self._fills(targets[0], value)
        ):
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
            self.emit(f"const {self.dialect.type_of(kind)} {name} = {self.text(found)};")
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
        self.emit(f"for (int {place} = 0; {place} < {size}; {place}++) {{")
        flat = Array(array.code, (size,), array.root, array.offset)
        entry = self.entry(flat, [Scalar(INT, place)], target)
        self.emit(f"    {entry} = {self.converted(number, REAL, target)};")
        self.emit("}")
        return True

    def _unpack(self, node: ast.stmt, targets: list[ast.expr], value: ast.expr) -> None:
        if isinstance(value, ast.Tuple):
            found = [self.value(item, alone=True) for item in value.elts]
            found = self._settled(targets, value.elts, found)
        else:
            many = as_many(self.value(value, alone=True))
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
                self.emit(f"const {self.dialect.type_of(value.kind)} {name} = {value.code};")
                value = Scalar(value.kind, name)
            settled.append(value)
        return settled

    def _store(self, target: ast.expr, value: Value, node: ast.stmt) -> None:
        if isinstance(target, ast.Name):
            self._name(target, value, node)
        elif isinstance(target, ast.Subscript | ast.Attribute):
            place = self.target(target, kind_of(value))
            self.emit(f"{place.code} = {self.converted(value, place.kind, node)};")
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
                self.declare_variable(name, value, hoisted=not self._is_first(name, target))
            else:
                self.emit(f"{held.code} = {self.converted(value, held.kind, node)};")
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
        return (
            all(len(place) == depth + 1 for place in firsts)
            and any(place[depth][1] == first for place in firsts)
            and self._starts_with_store(name, target)
        )

    def _starts_with_store(self, name: str, target: ast.Name) -> bool:
        for n in self.source.uses[name]:
            before = (n.lineno, n.col_offset) < (target.lineno, target.col_offset)
            if before and isinstance(n.ctx, ast.Store):
                return False
        return True

    def declare_variable(self, name: str, value: Value, *, hoisted: bool) -> None:
        """Declare a number with its first value, here or at the start of the function."""
        kind, c_name = kind_of(value), identifier(name)
        assert kind is not None
        self.environment[name] = Scalar(kind, c_name)
        type_name = self.dialect.type_of(kind)
        text = self.converted(value, kind, self.source.tree)
        if hoisted:
            zero = {REAL: self.dialect.number(0.0), BOOL: "false"}.get(kind, "0")
            self.hoist(f"{type_name} {c_name} = {zero};")
            self.emit(f"{c_name} = {text};")
            return
        fixed = self.source.stored.get(name, 0) <= 1 and not self._is_known_argument(name)
        self.emit(f"{'const ' if fixed else ''}{type_name} {c_name} = {text};", c_name)

    def _is_known_argument(self, name: str) -> bool:
        return (
            name
            in self.source.function.__code__.co_varnames[
                : self.source.function.__code__.co_argcount
            ]
        )

    def _name_array(self, name: str, value: Array, node: ast.stmt, once: bool) -> None:
        if value.data is not None and once:
            self.environment[name] = value
            return
        c_name, held = identifier(name), self.environment.get(name)
        text = self.pointer(value)
        if held is None or (
            isinstance(held, Array) and held.shape == value.shape and not self._in_scope(c_name)
        ):
            root = Root(views=value.root)
            self.scopes[-1].add(c_name)
            real, fixed = self.dialect.real, " const" if once else ""
            self.emit(
                lambda: (
                    f"{'' if root.written else 'const '}{real} *{fixed}{c_name} = {text};".replace(
                        "* const", "*const "
                    )
                ),
                c_name,
            )
            self.environment[name] = Array(c_name, value.shape, root)
        else:
            raise self.source.refuse(node, f"{name} is two arrays in turn: give each a name")

    def _in_scope(self, c_name: str) -> bool:
        return any(c_name in names for names in self.scopes)

    def _name_rows(self, name: str, value: Rows) -> None:
        c_name, root = identifier(name), Root(views=value.root)
        rest = f"{value.struct.name} *const {c_name} = {value.code};"
        self.emit(lambda: rest if root.written else f"const {rest}", c_name)
        self.environment[name] = Rows(c_name, value.struct, root)


def as_many(value: Value) -> Value:
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
