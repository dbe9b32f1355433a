"""From what a user hands over to smoothed pieces in the order of the arm's joints."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.identification.filtering import (
    Piece,
    is_regular,
    joint_positions,
    period_of,
    smoothed,
    unbroken,
)
from fotsmc_pin.identification.log import Log
from fotsmc_pin.simulation import Recording

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


NAMES = {"logs": "log", "validate": "validation log"}
"""What a log is called that has no name, by the argument that it was given as."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ReadLog:
    """A log whose columns are the arm's.

    Attributes:
        log: with the arm's joints in the arm's order; torque without what the robot adds.
        pieces: the unbroken stretches, smoothed; their torque is total as far as that is known.
        notes: what was decided, in plain words.
    """

    log: Log
    pieces: tuple[Piece, ...]
    notes: tuple[str, ...]


def read_logs(arm: Arm, logs: object, argument: str = "logs") -> list[ReadLog]:
    """Return the logs, checked one by one and against each other.

    Raises:
        ArgumentError: no log, one that misses a joint of the arm, or kinds of torque that differ.
    """
    given: Sequence[Any] = logs if isinstance(logs, (list, tuple)) else [logs]
    if not given:
        raise ArgumentError(argument, logs, "give at least one log or recording")
    names = [f"{NAMES[argument]} {k}" for k in range(1, len(given) + 1)]
    found = [
        in_order_of(arm, as_log(entry, name), argument)
        for entry, name in zip(given, names, strict=True)
    ]
    kinds = {(log.torque, frozenset(log.compensates)) for log in found}
    if len(kinds) > 1:
        words = "; ".join(f"{log.label}: {_left_out(log)}" for log in found)
        raise ArgumentError(
            argument,
            [log.source for log in found],
            f"they mean different things by torque ({words}); a fit of both would explain neither: "
            "identify from logs of one kind",
        )
    return [_pieces(arm, log, argument) for log in found]


def as_log(entry: Any, name: str) -> Log:
    """Return a log of anything that has the attributes of one.

    Raises:
        ArgumentError: an attribute is missing.
    """
    if isinstance(entry, Log):
        return entry if entry.source else replace(entry, source=name)
    if isinstance(entry, Recording):
        return Log.from_recording(entry, source=name)
    missing = [word for word in ("t", "q", "tau", "joint_names") if not hasattr(entry, word)]
    if missing:
        raise ArgumentError(
            "logs", entry, f"it has no {', '.join(missing)}; give recordings, or logs as Log"
        )
    return Log(
        t=entry.t,
        q=entry.q,
        v=getattr(entry, "v", None),
        tau=entry.tau,
        joint_names=entry.joint_names,
        compensates=tuple(getattr(entry, "compensates", ())),
        torque=getattr(entry, "torque", "measured"),
        source=getattr(entry, "source", "") or name,
    )


def in_order_of(arm: Arm, log: Log, argument: str) -> Log:
    """Return the log with the arm's joints alone, in the arm's order.

    Raises:
        ArgumentError: a joint is missing, or `q` has a wrong number of columns.
    """
    missing = [name for name in arm.joint_names if name not in log.joint_names]
    if missing:
        raise ArgumentError(
            argument,
            log.joint_names,
            f"{log.label} has no joint {missing[0]!r}; the arm's joints are "
            f"{', '.join(arm.joint_names)}",
        )
    sizes = {
        name: int(joint.nq)
        for name, joint in zip(arm.joint_names, [*arm.model.joints][1:], strict=True)
    }
    widths = [sizes.get(name, 1) for name in log.joint_names]
    if log.q.shape[1] != sum(widths):
        raise ArgumentError(
            argument,
            log.q.shape,
            f"{log.label}: q has {log.q.shape[1]} columns for joints {', '.join(log.joint_names)}; "
            f"give {sum(widths)}, a continuous joint with its cosine and sine",
        )
    starts = dict(zip(log.joint_names, np.cumsum([0, *widths[:-1]]).tolist(), strict=True))
    at = dict(zip(log.joint_names, range(len(log.joint_names)), strict=True))
    columns = [starts[name] + k for name in arm.joint_names for k in range(sizes[name])]
    own = [at[name] for name in arm.joint_names]
    return replace(
        log,
        q=log.q[:, columns],
        v=None if log.v is None else log.v[:, own],
        tau=log.tau[:, own],
        joint_names=arm.joint_names,
    )


def _pieces(arm: Arm, log: Log, argument: str) -> ReadLog:
    stretches = unbroken(log.t)
    if not stretches:
        raise ArgumentError(
            argument, log.duration, f"{log.label} is too short or full of gaps; record 10 s or more"
        )
    notes = []
    if len(stretches) > 1:
        notes.append(f"{log.label}: gaps in its clock; {len(stretches)} pieces between them used")
    if not is_regular(log.t):
        notes.append(
            f"{log.label}: samples come irregularly; brought to {1.0 / period_of(log.t):.4g} Hz"
        )
    x, tau = joint_positions(arm, log.q), log.tau
    if "gravity" in log.compensates:
        tau = tau + np.array([arm.gravity(q) for q in log.q])
        notes.append(
            f"{log.label}: the robot adds gravity itself; that of {arm.name} was added here, so an "
            "error of the robot's own model of gravity goes into the masses"
        )
    if "coriolis" in log.compensates:
        tau = tau + _coriolis_torque(arm, log, x)
        notes.append(
            f"{log.label}: the robot adds Coriolis torque itself; that of {arm.name} was added here"
        )
    if "friction" in log.compensates:
        notes.append(
            f"{log.label}: the robot makes up for friction itself; what is identified is the rest"
        )
    pieces = tuple(smoothed(log.t[part], x[part], tau[part]) for part in stretches)
    return ReadLog(log=log, pieces=pieces, notes=tuple(notes))


def _coriolis_torque(arm: Arm, log: Log, x: Array) -> Array:
    """Return `C(q, v) v` of each row (T, nv), by the slope of `x` (T, nv) where `v` is missing."""
    v = np.gradient(x, log.t, axis=0) if log.v is None else log.v
    still = np.zeros(arm.nv)
    moving = [arm.inverse_dynamics(q, speed, still) for q, speed in zip(log.q, v, strict=True)]
    return np.asarray(np.array(moving) - np.array([arm.gravity(q) for q in log.q]))


def _left_out(log: Log) -> str:
    what = f"without {' and '.join(log.compensates)}" if log.compensates else "total"
    return f"{what}, {log.torque}"
