"""The lines of a C function while they are made."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.export.dialect import comment

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


class Lines:
    """The lines of one function, and what its local names are.

    Attributes:
        program: the C program.
        source: the kernel.
        dialect: double or single precision.
        environment: what each local name is.
        counting: names that count a loop around the present statement.
        indent: depth of the present statement.
        scopes: for each block around the present statement, the pointers that it declares.
    """

    def __init__(self, program: Program, source: Source) -> None:
        self.program, self.source = program, source
        self.dialect = program.dialect
        self.environment: dict[str, Value] = {}
        self.counting: list[str] = []
        self.indent = 1
        self.scopes: list[set[str]] = [set()]
        self._lines: list[Line] = []
        self._hoisted: list[Line] = []
        self._commented = source.tree.body[0].lineno - 1
        self._temporaries = 0

    @property
    def is_empty(self) -> bool:
        """Whether nothing was written yet."""
        return not self._lines

    def emit(self, text: str | Callable[[], str], declares: str | None = None) -> None:
        """Write a line; it may be left out where it declares what nothing reads."""
        indent = "    " * self.indent
        write = text if callable(text) else lambda: text
        self._lines.append(Line(lambda: indent + write(), declares))

    def hoist(self, text: str) -> None:
        """Write a line at the start of the function."""
        self._hoisted.append(Line(lambda: f"    {text}"))

    def temporary(self, word: str = "now") -> str:
        """Return the name of a variable that no kernel has."""
        self._temporaries += 1
        return f"{word}_v{self._temporaries}"

    def comment_until(self, line: int) -> None:
        """Write the comments that stand before a line of the kernel."""
        comments = self.source.comments
        found = [comments[k] for k in range(self._commented + 1, line) if k in comments]
        self.skip_comments(line)
        if found:
            for text in comment("\n".join(found), "    " * self.indent):
                self._lines.append(Line(_constant(text), is_comment=True))

    def skip_comments(self, line: int) -> None:
        """Leave out the comments that stand before a line of the kernel."""
        self._commented = max(self._commented, line)

    def finished(self) -> tuple[list[str], str]:
        """Return all lines, and the text of those that are no comments.

        What nothing reads is left out, and what only that has read.
        """
        lines = [*self._hoisted, *self._lines]
        while True:
            texts = [line.write() for line in lines]
            code = "\n".join(t for t, ln in zip(texts, lines, strict=True) if not ln.is_comment)
            kept = [
                line
                for line in lines
                if line.declares is None or len(re.findall(rf"\b{line.declares}\b", code)) > 1
            ]
            if len(kept) == len(lines):
                return texts, code
            lines = kept


def _constant(text: str) -> Callable[[], str]:
    return lambda: text
