"""The functions of a C program: each kernel, once for each size of its arrays."""

from __future__ import annotations

import inspect
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from fotsmc_pin.export.body import Body
from fotsmc_pin.export.dialect import Dialect, comment, identifier
from fotsmc_pin.export.source import Source
from fotsmc_pin.export.values import Array, Constant, Many, Root, Rows, Scalar, Table, signature

if TYPE_CHECKING:
    import ast
    from collections.abc import Hashable, Sequence

    from fotsmc_pin.export.values import Value

HELPERS = {
    "square": ("{real} square({real} x)", ["return x * x;"]),
    "cube": ("{real} cube({real} x)", ["return x * (x * x);"]),
    "least": ("{real} least({real} a, {real} b)", ["return b < a ? b : a;"]),
    "greatest": ("{real} greatest({real} a, {real} b)", ["return b > a ? b : a;"]),
    "floored": (
        "long long floored(long long a, long long b)",
        ["return a / b - (a % b != 0 && (a % b < 0) != (b < 0));"],
    ),
    "remaining": (
        "long long remaining(long long a, long long b)",
        ["return a % b + ((a % b != 0 && (a % b < 0) != (b < 0)) ? b : 0);"],
    ),
    "whole": (
        "long long whole({real} x)",
        [
            "/* Beyond this a conversion would not be defined. */",
            "if (!(x > {low})) {{ return -4611686018427387904LL; }}",
            "return x < {high} ? (long long)x : 4611686018427387904LL;",
        ],
    ),
}
"""Short functions that stand for Python's own, by name: their head and their body."""

AROUND = (
    *("are_finite", "understood", "see", "follow", "begin_stop"),
    *("is_due", "ready", "regressor_due", "give_regressor", "learned_model"),
)
"""Functions that are written around the kernels."""


@dataclass
class Function:
    """One C function.

    Attributes:
        name: its name in C.
        arguments: names in C of what it takes, each with its value inside.
        kept: places of the arguments that it uses; the others are left out.
        result: kind of the number that it returns, kinds of several, or None.
        head: its declaration.
        lines: its text.
        writes: whether it writes to memory of its caller.
        always: what it returns, where it does nothing else than return what is known.
    """

    name: str
    arguments: list[tuple[str, Value]] = field(default_factory=list)
    kept: list[int] = field(default_factory=list)
    result: str | tuple[str, ...] | None = None
    head: str = ""
    lines: list[str] = field(default_factory=list)
    writes: bool = False
    always: Value | None = None


class Program:
    """Translates kernels and those that they call, each before its caller.

    Attributes:
        dialect: double or single precision.
        functions: what was translated, in order.
    """

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect
        self.functions: list[Function] = []
        self._found: dict[Hashable, Function | None] = {}
        self._names = dict.fromkeys(AROUND, 1)
        self._helpers: set[str] = set()
        self._tuples: dict[tuple[str, ...], str] = {}

    def function(
        self, kernel: Any, values: Sequence[Value], *, caller: Source | None, node: ast.AST | None
    ) -> Function:
        """Return the function that does what `kernel` does with arguments of such types.

        Raises:
            TranslationError: a kernel contains what is not translated.
        """
        plain = getattr(kernel, "py_func", kernel)
        key = (plain, *(signature(value) for value in values))
        if key in self._found:
            found = self._found[key]
            if found is None:
                assert caller is not None
                raise caller.refuse(node, f"{plain.__name__} calls itself: write a loop")
            return found
        self._found[key] = None
        made = self._translated(Source.of(kernel), values)
        self._found[key] = made
        self.functions.append(made)
        return made

    def helper(self, name: str) -> str:
        """Return the name of a short function, which is then written."""
        self._helpers.add(name)
        return name

    def tuple_type(self, kinds: tuple[str, ...]) -> str:
        """Return the type of a struct for several results."""
        return self._tuples.setdefault(kinds, f"{'_'.join(kinds)}_results")

    def text(self, *roots: str) -> list[str]:
        """Return all that these functions need, as C."""
        written = [*self._tuple_lines()]
        for name, (head, body) in HELPERS.items():
            if name in self._helpers:
                words = {
                    "real": self.dialect.real,
                    "low": self.dialect.number(-(2.0**62)),
                    "high": self.dialect.number(2.0**62),
                }
                inner = [f"    {line.format(**words)}" for line in body]
                written += [f"static {head.format(**words)} {{", *inner, "}", ""]
        needed, texts = set(roots), []
        for function in reversed(self.functions):
            if function.name in needed:
                texts.append(function.lines)
                needed |= set(re.findall(r"\w+", "\n".join(function.lines)))
        for lines in reversed(texts):
            written += [*lines, ""]
        return written

    def _tuple_lines(self) -> list[str]:
        lines = []
        for kinds, name in self._tuples.items():
            lines.append("typedef struct {")
            lines += [f"    {self.dialect.type_of(kind)} r{k};" for k, kind in enumerate(kinds)]
            lines += [f"}} {name};", ""]
        return lines

    def _translated(self, source: Source, values: Sequence[Value]) -> Function:
        function = Function(self._new_name(source))
        names = list(inspect.signature(source.function).parameters)
        if len(names) != len(values):
            raise source.refuse(source.tree, f"{len(values)} arguments for {len(names)}")
        environment: dict[str, Value] = {}
        known: dict[str, Constant] = {}
        for name, value in zip(names, values, strict=True):
            inside = _inside(identifier(name), value)
            if isinstance(inside, Constant):
                known[name] = inside
            environment[name] = inside
            function.arguments.append((identifier(name), inside))
        body = Body(self, source, environment, known)
        lines = body.translated()
        function.result, function.always = body.result, body.always
        text = body.code
        declared = []
        for k, (name, value) in enumerate(function.arguments):
            fixed = isinstance(value, Constant) or getattr(value, "data", None) is not None
            if not fixed and re.search(rf"\b{name}\b", text):
                function.kept.append(k)
                declared.append(self._declared(name, value))
                root = getattr(value, "root", None)
                function.writes |= root is not None and root.written
        result = "void"
        if isinstance(body.result, tuple):
            result = self.tuple_type(body.result)
        elif body.result is not None:
            result = self.dialect.type_of(body.result)
        function.head = f"static {result} {function.name}({', '.join(declared) or 'void'})"
        doc = inspect.getdoc(source.function) or source.function.__name__
        function.lines = [*comment(doc), f"{function.head} {{", *lines, "}"]
        return function

    def _declared(self, name: str, value: Value) -> str:
        if isinstance(value, Scalar):
            return f"{self.dialect.type_of(value.kind)} {name}"
        if isinstance(value, Array):
            return f"{'' if value.root.written else 'const '}{self.dialect.real} *{name}"
        if isinstance(value, Rows):
            return f"{'' if value.root.written else 'const '}{value.struct.name} *{name}"
        assert isinstance(value, Table)
        return f"{'' if value.root.written else 'const '}{value.type_name} *{name}"

    def _new_name(self, source: Source) -> str:
        plain = source.function.__name__
        name = f"{source.module}{plain}" if plain.startswith("_") else plain
        name = identifier(name)
        count = self._names[name] = self._names.get(name, 0) + 1
        return name if count == 1 else f"{name}_v{count}"


def _inside(name: str, value: Value) -> Value:
    """Return what an argument is inside of the function that takes it."""
    match value:
        case Constant(number, decides=False) if isinstance(number, float):
            return Scalar("real", name)
        case Array(data=data) if data is not None:
            return value
        case Scalar(kind):
            return Scalar(kind, name)
        case Array(shape=shape):
            return Array(name, shape, Root())
        case Rows(struct=struct):
            return Rows(name, struct, Root())
        case Table(type_name=type_name, groups=groups, width=width):
            return Table(name, type_name, groups, width, Root())
        case Many():
            raise TypeError("a tuple")
        case _:
            return value
