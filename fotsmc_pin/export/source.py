"""The source of a kernel: its syntax tree, its comments, and what its names mean."""

from __future__ import annotations

import ast
import builtins
import inspect
import io
import textwrap
import tokenize
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.errors import TranslationError

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True)
class Source:
    """A function in Python, read.

    Attributes:
        function: the plain function.
        tree: its syntax tree.
        rounds_freely: whether the order of sums does not matter to it.
        comments: comments that stand alone, by their line in `tree`.
        scope: what its global names and those of the functions around it mean.
        stored: how often each name is assigned.
        places: for each name that is assigned, the places where it occurs (see `_places`).
        uses: the nodes of each name.
        counted: identities of the nodes of a name that stand in a loop over it.
    """

    function: Any
    tree: ast.FunctionDef
    rounds_freely: bool
    comments: Mapping[int, str]
    scope: Mapping[str, Any]
    stored: Mapping[str, int]
    places: Mapping[str, list[tuple[tuple[int, int], ...]]]
    uses: Mapping[str, list[ast.Name]]
    counted: frozenset[int]

    @classmethod
    @cache
    def of(cls, function: Any) -> Source:
        """Read a kernel.

        Raises:
            TranslationError: its source is not there.
        """
        plain = getattr(function, "py_func", function)
        try:
            text = textwrap.dedent(inspect.getsource(plain))
        except (OSError, TypeError):
            name = getattr(plain, "__qualname__", repr(plain))
            raise TranslationError(
                f"{name}: its source is not there; write it in a file, as a function with @kernel"
            ) from None
        tree = ast.parse(text).body[0]
        if not isinstance(tree, ast.FunctionDef):
            raise TranslationError(f"{plain.__qualname__}: is no function that `def` defines")
        cells = zip(plain.__code__.co_freevars, plain.__closure__ or (), strict=True)
        scope = {**vars(builtins), **plain.__globals__, **{n: c.cell_contents for n, c in cells}}
        free = bool(getattr(function, "targetoptions", {}).get("fastmath"))
        return cls(
            plain,
            tree,
            free,
            _comments(text),
            scope,
            _stored(tree),
            _places(tree),
            _uses(tree),
            _counted(tree),
        )

    def refuse(self, node: ast.AST | None, construct: str) -> TranslationError:
        """Return the error that names file, line and construct."""
        first = self.function.__code__.co_firstlineno
        line = first + (getattr(node, "lineno", 1) - 1)
        path = self.function.__code__.co_filename
        return TranslationError(f"{path}:{line}: {construct}")

    @property
    def module(self) -> str:
        """Name of the file, without its folder and ending."""
        return Path(self.function.__code__.co_filename).stem


def _comments(text: str) -> dict[int, str]:
    found = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and token.line.strip().startswith("#"):
            found[token.start[0]] = token.string.lstrip("# ")
    return found


def _stored(tree: ast.FunctionDef) -> dict[str, int]:
    count: dict[str, int] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            count[node.id] = count.get(node.id, 0) + 1
    return count


def _places(tree: ast.FunctionDef) -> dict[str, list[tuple[tuple[int, int], ...]]]:
    """Return where each assigned name occurs: pairs of block and statement, from the outside in.

    A block is the identity of its list of statements.
    """
    found: dict[str, list[tuple[tuple[int, int], ...]]] = {}

    def visit(block: list[ast.stmt], above: tuple[tuple[int, int], ...]) -> None:
        for k, statement in enumerate(block):
            here = (*above, (id(block), k))
            inner = [b for name in ("body", "orelse") if (b := getattr(statement, name, None))]
            within = {id(node) for b in inner for part in b for node in ast.walk(part)}
            for node in ast.walk(statement):
                if isinstance(node, ast.Name) and id(node) not in within:
                    found.setdefault(node.id, []).append(here)
            for b in inner:
                if isinstance(b, list):
                    visit(b, here)

    visit(tree.body, ())
    stored = _stored(tree)
    return {name: places for name, places in found.items() if name in stored}


def _uses(tree: ast.FunctionDef) -> dict[str, list[ast.Name]]:
    found: dict[str, list[ast.Name]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            found.setdefault(node.id, []).append(node)
    return found


def _counted(tree: ast.FunctionDef) -> frozenset[int]:
    return frozenset(
        id(node)
        for loop in ast.walk(tree)
        if isinstance(loop, ast.For) and isinstance(loop.target, ast.Name)
        for node in ast.walk(loop)
        if isinstance(node, ast.Name) and node.id == loop.target.id
    )
