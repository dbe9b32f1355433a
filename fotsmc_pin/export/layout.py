"""The two files: what a caller sees in the header, and the program."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.export.dialect import Dialect, comment, member_name
from fotsmc_pin.export.values import Constant

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from fotsmc_pin.export.values import Struct

STATUSES = (
    ("OK", "the tick was done"),
    ("BAD_Q", "q is not finite, or the pair of a continuous joint is not on the unit circle"),
    ("BAD_V", "v is not finite"),
    ("BAD_Q_D", "q_d is not finite, or a pair of it is not on the unit circle"),
    ("BAD_V_D", "v_d is not finite"),
    ("BAD_A_D", "a_d is not finite"),
    ("BAD_DT", "dt is not finite, or below 1e-3 or above 1e6 nominal periods"),
    ("BAD_MODEL", "M or h is not finite or too large, or the diagonal of M is not above zero"),
)
"""Status codes, in the order of their values, with their meaning."""


def statuses(macro: str, meanings: Sequence[tuple[str, str]]) -> list[str]:
    """Return the status codes."""
    lines = [*comment("What a tick reports."), "enum {"]
    for k, (name, meaning) in enumerate(meanings):
        lines.append(
            f"    {macro}_{name} = {k}{',' if k < len(meanings) - 1 else ''} /* {meaning} */"
        )
    return [*lines, "};", ""]


def struct_lines(
    struct: Struct, notes: dict[str, str], dialect: Dialect, only: Iterable[str] | None = None
) -> list[str]:
    """Return the definition of a struct of named rows, with what each member is."""
    lines = ["typedef struct {"]
    for name, shape in struct.fields.items():
        if isinstance(shape, Constant) or (only is not None and name not in only):
            continue
        size = "".join(f"[{n}]" for n in shape)
        note = f" /* {notes[name]} */" if name in notes else ""
        lines.append(f"    {dialect.real} {member_name(name)}{size};{note}")
    return [*lines, f"}} {struct.name};", ""]


def notes_of(kind: Any) -> dict[str, str]:
    """Return what the docstring of a class says of each of its attributes."""
    found: dict[str, str] = {}
    doc = textwrap.dedent(kind.__doc__ or "")
    if "Attributes:" not in doc:
        return found
    name = ""
    for line in doc.split("Attributes:", 1)[1].splitlines():
        if line and not line.startswith(" "):
            break
        head, colon, rest = line.strip().partition(": ")
        if (
            colon
            and head.isidentifier()
            and len(line) - len(line.lstrip()) <= 8
            and not _continues(line, doc)
        ):
            name = head
            found[name] = rest
        elif name and line.strip():
            found[name] += f" {line.strip()}"
    return {name: note.replace("*/", "* /") for name, note in found.items()}


def _continues(line: str, doc: str) -> bool:
    listed = [ln for ln in doc.split("Attributes:", 1)[1].splitlines() if ln.strip()]
    return bool(listed) and len(line) - len(line.lstrip()) > len(listed[0]) - len(
        listed[0].lstrip()
    )


def numbers(name: str, values: Any, dialect: Dialect) -> list[str]:
    """Return constant data, a row of a table after the other."""
    rows = np.atleast_2d(np.asarray(values, dtype=np.float64))
    lines = [f"static const {dialect.real} {name}[{rows.size}] = {{"]
    for row in rows:
        text = ", ".join(dialect.number(float(value)) for value in row)
        lines += textwrap.wrap(text, 96, initial_indent="    ", subsequent_indent="    ")
        lines[-1] += ","
    return [*lines, "};", ""]


def assigned(target: str, values: Any, dialect: Dialect) -> list[str]:
    """Return assignments of numbers to an array, or of one to a number."""
    flat = np.asarray(values, dtype=np.float64)
    if flat.ndim == 0:
        return [f"{target} = {dialect.number(float(flat))};"]
    flat = flat.ravel()
    if flat.size > 3 and np.all(flat == flat[0]):
        number = dialect.number(float(flat[0]))
        return [f"for (int i = 0; i < {flat.size}; i++) {{ {target}[i] = {number}; }}"]
    places = enumerate(flat)
    return [f"{target}[{k}] = {dialect.number(float(value))};" for k, value in places]


def wrapped(head: str) -> list[str]:
    """Return a declaration, broken where it is long."""
    if len(head) <= 100:
        return [head]
    start, inside = head.split("(", 1)
    return [
        f"{start}(",
        *textwrap.wrap(inside, 92, initial_indent="    ", subsequent_indent="    "),
    ]


def block(head: str, lines: Sequence[str], note: str) -> list[str]:
    """Return a function."""
    return [
        *comment(note),
        f"{head} {{",
        *(f"    {line}" if line else "" for line in lines),
        "}",
        "",
    ]
