"""Names for the rows of a law's table: `x, g, m, w = rows(table, Gains, State, Work)`.

All numbers of a law that have an entry per joint are rows of one table (rows, nv), since each array
that is handed to a compiled function costs time: first what every tick brings, `Joints`, then the
law's gains, its state and its work. A kernel names them; the names cost nothing when it runs.
"""

from __future__ import annotations

from collections import namedtuple
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numba.core import types
from numba.extending import overload, typeof_impl

from fotsmc_pin.control.gains import GainsType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.control.gains import Gains
    from fotsmc_pin.types import Array

    G = TypeVar("G")
    S = TypeVar("S")
    W = TypeVar("W")


class Joints(NamedTuple):
    """What every tick brings, and the torque that it gives.

    Attributes:
        e: tracking error `q ⊖ q_d` [rad, m].
        e_dot: its rate `v - v_d` [rad/s, m/s].
        v: measured velocity [rad/s, m/s].
        v_d: reference velocity [rad/s, m/s].
        a_d: reference acceleration [rad/s², m/s²].
        tau: torque of the last tick, to be replaced by that of this one [N·m, N].
        effort_limit: largest torque [N·m, N].
        tau_extra: torque that acted over the last tick beyond the one that the law asked for, where
            another law acts too; else 0 [N·m, N].
    """

    e: Array
    e_dot: Array
    v: Array
    v_d: Array
    a_d: Array
    tau: Array
    effort_limit: Array
    tau_extra: Array


class NoRows(NamedTuple):
    """State of a law that remembers nothing, or work of one that needs none."""


def rows(table: Array, gains: type[G], state: type[S], work: type[W]) -> tuple[Joints, G, S, W]:
    """Return the rows of a law's table by name: of the joints, the gains, the state and the work.

    Gains that the whole arm shares are numbers, options are their codes and flags 0 or 1; all else
    is a vector (nv,), a view of the table.
    """
    named: list[Any] = []
    start = 0
    for kind in (Joints, gains, state, work):
        names = row_names(kind)
        vectors = _vectors(names)
        places = enumerate(vectors, start)
        named.append(names(*(table[k] if whole else table[k, 0] for k, whole in places)))
        start += len(vectors)
    return tuple(named)


def named_rows(table: Array, kind: type[S]) -> S:
    """Return the first rows of any table as the `NamedTuple` `kind`, which names them."""
    names: Any = kind
    named: S = names(*table[: len(names._fields)])
    return named


def new_table(gains: Gains, state: type, work: type, effort_limit: Array) -> Array:
    """Return the table of a law, with gains and effort limits filled in and all else zero."""
    n = effort_limit.size
    filled = gains.rows(n)
    remaining = len(row_names(state)._fields) + len(row_names(work)._fields)
    table = np.vstack([np.zeros((len(Joints._fields), n)), filled, np.zeros((remaining, n))])
    rows(table, type(gains), state, work)[0].effort_limit[:] = effort_limit
    return table


def signal_views(
    table: Array,
    gains: type,
    state: type,
    work: type,
    signal_rows: Mapping[str, str | tuple[str, ...]],
) -> dict[str, Array]:
    """Return live views of the rows that a law shows, by the name of the signal.

    Args:
        table: the law's table.
        gains: the law's `Gains`.
        state: the law's `State`.
        work: the law's `Work`.
        signal_rows: the row of each signal; or neighbouring rows that hold one number each, the
            same for every joint, to be shown as one vector.
    """
    start = len(Joints._fields) + len(row_names(gains)._fields)
    names = (*row_names(state)._fields, *row_names(work)._fields)
    place = {name: k for k, name in enumerate(names, start)}
    return {
        signal: table[place[shown]]
        if isinstance(shown, str)
        else table[place[shown[0]] : place[shown[-1]] + 1, 0]
        for signal, shown in signal_rows.items()
    }


def row_names(kind: type) -> Any:
    """Return the `NamedTuple` of the rows that `kind` describes: itself, or that of gains."""
    return _gain_names(kind) if isinstance(kind, GainsType) else kind


@cache
def _gain_names(gains: Any) -> Any:
    make: Any = namedtuple  # Its names are known when it runs only.
    names = make(gains.__name__, [f.name for f in fields(gains)])
    names.vectors = tuple(f.metadata["kind"] == "per joint" for f in fields(gains))
    return names


def _vectors(names: Any) -> tuple[bool, ...]:
    """Return for each row whether it has an entry per joint."""
    found: tuple[bool, ...] = getattr(names, "vectors", (True,) * len(names._fields))
    return found


@typeof_impl.register(GainsType)
def _type_of_gains(gains: Any, context: Any) -> types.NamedTupleClass:
    """Tell Numba what the name of a `Gains` class means inside a kernel."""
    return types.NamedTupleClass(row_names(gains))


@overload(rows)
def _compiled_rows(table, gains, state, work):  # type: ignore[no-untyped-def]
    """Write `rows` out for the given names, so that the compiler sees constant places only."""
    scope: dict[str, Any] = {}
    groups: list[str] = []
    start = 0
    for kind in (Joints, gains.instance_class, state.instance_class, work.instance_class):
        vectors = _vectors(kind)
        places = enumerate(vectors, start)
        found = ", ".join(f"table[{k}]" if whole else f"table[{k}, 0]" for k, whole in places)
        group = f"Names{len(groups)}"
        scope[group] = kind
        groups.append(f"{group}({found})")
        start += len(vectors)
    source = f"def written_out(table, gains, state, work):\n    return {', '.join(groups)}"
    exec(source, scope)  # made of the names above alone
    return scope["written_out"]


@overload(named_rows)
def _compiled_named_rows(table, kind):  # type: ignore[no-untyped-def]
    """Write `named_rows` out for the given names."""
    names = kind.instance_class
    found = ", ".join(f"table[{k}]" for k in range(len(names._fields)))
    scope: dict[str, Any] = {"Names": names}
    exec(f"def written_out(table, kind):\n    return Names({found})", scope)
    return scope["written_out"]
