"""Loops of a kernel as C."""

from __future__ import annotations

import ast
from abc import abstractmethod

from fotsmc_pin.export.assignments import Assignments
from fotsmc_pin.export.dialect import identifier
from fotsmc_pin.export.values import INT, LONG, REAL, Array, Constant, Many, Scalar, kind_of


class Loops(Assignments):
    """Translates loops."""

    @abstractmethod
    def nested(
        self,
        head: str,
        statements: list[ast.stmt],
        declares: str | None = None,
        first: str | None = None,
    ) -> bool:
        """Translate a block under its head; return whether it ends with a way out."""

    def loop(self, node: ast.For) -> bool:
        """Translate `for`; such a loop is never a way out."""
        if not isinstance(node.target, ast.Name) or node.orelse:
            raise self.source.refuse(node, "`for` with several targets or with `else`")
        name, loops = node.target.id, self.counting
        if name in loops or any(
            isinstance(n, ast.Name) and n.id == name and isinstance(n.ctx, ast.Store)
            for statement in node.body
            for n in ast.walk(statement)
        ):
            raise self.source.refuse(node, f"{name}, which counts the loop, is assigned in it")
        for other in self.source.uses[name]:
            if id(other) not in self.source.counted:
                raise self.source.refuse(other, f"{name} is used outside the loop over it")
        before = self.environment.get(name)
        counted = self._range(node)
        if counted is not None:
            head, kind = counted
            self.environment[name] = Scalar(kind, identifier(name))
            self.counting.append(name)
            if not self._summed_by_two(node):
                self.nested(head, node.body, identifier(name))
                self.emit("}")
            self.counting.pop()
        if before is not None:
            self.environment[name] = before
        return False

    def _summed_by_two(self, node: ast.For) -> bool:
        """Translate a loop that sums, with two partial sums, if its kernel allows it.

        A sum whose terms wait for each other takes twice as long.
        """
        assert isinstance(node.target, ast.Name)
        sums = self._sums(node) if self.source.rounds_freely else []
        bounds = self._known_bounds(node)
        if not sums or bounds is None or bounds[1] - bounds[0] < 4:
            return False
        (start, stop), name = bounds, identifier(node.target.id)
        even = start + (stop - start) // 2 * 2
        outside = dict(self.environment)
        zero = self.dialect.number(0.0)
        for total in sums:
            self.emit(f"{self.dialect.real} {total}_by_two[2] = {{{zero}, {zero}}};")
            self.environment[total] = Scalar(REAL, f"{total}_by_two[part]")
        self.emit(f"for (int pair = {start}; pair < {even}; pair += 2) {{")
        self.indent += 1
        first = f"const int {name} = pair + part;"
        self.nested("for (int part = 0; part < 2; part++) {", node.body, name, first)
        self.emit("}")
        self.indent -= 1
        self.emit("}")
        self.environment = dict(outside)
        if even < stop:
            self.nested(f"for (int {name} = {even}; {name} < {stop}; {name}++) {{", node.body, name)
            self.emit("}")
            self.environment = outside
        for total in sums:
            held = self.environment[total]
            self.emit(f"{self.text(held)} += {total}_by_two[0] + {total}_by_two[1];")
        return True

    def _sums(self, node: ast.For) -> list[str]:
        """Return the numbers that a loop only adds to; none where it is no plain loop."""
        parts = [n for statement in node.body for n in ast.walk(statement)]
        if any(isinstance(n, ast.For | ast.While | ast.Break | ast.Return) for n in parts):
            return []
        added = [
            n.target.id
            for n in node.body
            if isinstance(n, ast.AugAssign)
            and isinstance(n.op, ast.Add)
            and isinstance(n.target, ast.Name)
        ]
        uses = [n.id for n in parts if isinstance(n, ast.Name)]
        stored = {n.id for n in parts if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        local = {name for name in stored if name not in self.environment}
        if any(not self._stays_inside(name, node) for name in local):
            return []
        return [
            name
            for name in dict.fromkeys(added)
            if uses.count(name) == 1 and kind_of(self.environment.get(name, Many(()))) == REAL
        ]

    def _stays_inside(self, name: str, node: ast.For) -> bool:
        inside = {id(n) for n in ast.walk(node)}
        return all(id(n) in inside for n in self.source.uses[name])

    def _known_bounds(self, node: ast.For) -> tuple[int, int] | None:
        call = node.iter
        if not isinstance(call, ast.Call) or len(call.args) > 2:
            return None
        bounds = [self.value(argument) for argument in call.args]
        if not all(isinstance(b, Constant) for b in bounds):
            return None
        numbers = [b.value for b in bounds if isinstance(b, Constant)]
        return (0, numbers[0]) if len(numbers) == 1 else (numbers[0], numbers[1])

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
            return f"{head}\n{'    ' * self.indent}{body}", REAL
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
            self.emit(
                f"const {self.dialect.type_of(kind_of(stop) or INT)} {end} = {self.text(stop)};"
            )
            stop = Scalar(kind_of(stop) or INT, end)
        kind = LONG if LONG in (kind_of(start), kind_of(stop)) else INT
        compare, move = ("<", "++") if step > 0 else (">", "--")
        move = move if abs(step) == 1 else f" {'+' if step > 0 else '-'}= {abs(step)}"
        return (
            f"for ({self.dialect.type_of(kind)} {name} = {self.text(start)}; "
            f"{name} {compare} {self.text(stop)}; {name}{move}) {{"
        ), kind
