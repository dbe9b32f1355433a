"""A law's declaration, checked when its class is made: a slip shows up before the first run."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import Joints, row_names
from fotsmc_pin.errors import DeclarationError

if TYPE_CHECKING:
    from collections.abc import Iterator

FIRST_ARGUMENTS = ("dt", "table", "M0", "h0")
"""What every kernel takes first; a law's streams follow."""


def check_declaration(law: Any) -> None:
    """Check a class of controllers that has a kernel; one without is a frame for others.

    Raises:
        DeclarationError: what contradicts what, and the remedy.
    """
    if not hasattr(law, "tick"):
        return
    gains = getattr(law, "Gains", None)
    if not (isinstance(gains, type) and issubclass(gains, Gains)):
        raise DeclarationError(f"{law.__name__}.Gains = {gains!r}: give a subclass of Gains")
    _check_names(law)
    _check_signals(law)
    _check_kernel(law)


def _check_names(law: Any) -> None:
    seen: dict[str, str] = {}
    for owner, names in _rows_of(law):
        for name in names:
            if name in seen:
                raise DeclarationError(
                    f"{law.__name__}: {name!r} is a row of {seen[name]} and of {owner}: rename one"
                )
            seen[name] = owner


def _check_signals(law: Any) -> None:
    shown = [name for owner, names in _rows_of(law) if owner in ("State", "Work") for name in names]
    for signal, row in law.signal_rows.items():
        names = [row] if isinstance(row, str) else list(row)
        first = shown.index(names[0]) if names and names[0] in shown else len(shown)
        if not names or shown[first : first + len(names)] != names:
            raise DeclarationError(
                f"{law.__name__}.signal_rows[{signal!r}] = {row!r}: name a row of State or Work, "
                f"or several in their order; the rows are {', '.join(shown)}"
            )


def _check_kernel(law: Any) -> None:
    wanted = [*FIRST_ARGUMENTS]
    for stream in law.streams:
        wanted += [stream, f"{stream}_memory"]
    tick = inspect.getattr_static(law, "tick")
    if not isinstance(tick, staticmethod):
        raise DeclarationError(f"{law.__name__}.tick: make it a staticmethod, as it has no self")
    function = getattr(tick.__func__, "py_func", tick.__func__)
    found = list(inspect.signature(function).parameters)
    if found != wanted:
        raise DeclarationError(
            f"{law.__name__}.tick takes ({', '.join(found)}): with these streams give "
            f"({', '.join(wanted)})"
        )


def _rows_of(law: Any) -> Iterator[tuple[str, tuple[str, ...]]]:
    yield "Joints", Joints._fields
    for owner in ("Gains", "State", "Work"):
        yield owner, row_names(getattr(law, owner))._fields
