"""What is wrong with a log: named before anything is fitted to it.

Plain mistakes show in the numbers of one column: degrees in the place of radians, velocities that
are not those of the positions, a joint that rests. The others show when the log is explained in
several ways: as it stands, with one torque's sign turned, with two columns exchanged, with gravity
elsewhere or left out. Each explanation is fitted to a few hundred samples, with the same trust in
the nominal arm; where another one explains the log much better than as it stands, the log is
refused by that name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.errors import LogError
from fotsmc_pin.identification.explanations import FEWEST, Explanations, sample
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.reading import ReadLog
    from fotsmc_pin.identification.regressor import Equations
    from fotsmc_pin.identification.result import IdentifiedParameter
    from fotsmc_pin.types import Array

BETTER, AT_LEAST = 0.1, 25.0
"""Decrease of the misfit, which is a χ², by which another explanation is believed: its share of the
misfit of the log as it stands, and at the least."""
SHARES = {"sign": 0.02, "gravity-free": 0.02}
"""That share where a right log is explained far worse: a wrong sign, torque without gravity."""
BEYOND = 3.0
"""Positions over the limits, from which on they are not radians."""
TOO_FAST = 8.0
"""Speed over the velocity limit, from which on positions are not radians."""
DEGREE = np.pi / 180.0
UNLIKE = 0.3
"""Part of a velocity column that the positions may leave unexplained."""
ALIKE = 0.1
"""Share of that decrease within which two explanations are equally good."""
NOISY = 0.6
"""Correlation of a velocity with that of its positions which noise alone may leave."""
LEAST_TOLD = 0.5
"""Share of the base parameters that the logs are to tell."""
LEAST_TRAVEL = 0.02
"""Travel of a joint below which it tells nothing [rad, m]."""


class LogWarning(UserWarning):
    """A log tells less than it could."""


def demand_sense(arm: Arm, entry: ReadLog) -> None:
    """Refuse a log that is not what it should be.

    Raises:
        LogError: naming the mistake and its remedy.

    Warns:
        LogWarning: a joint hardly moved.
    """
    _demand_units(arm, entry)
    _demand_motion(arm, entry)
    _demand_velocities(arm, entry)
    _demand_best_explanation(arm, entry)


def warn_of_unused(arm: Arm, systems: Sequence[Equations]) -> None:
    """Warn of joints that nearly no equation is left of.

    Warns:
        LogWarning: naming the joints: they stick, or shake so that they turn round all the time.
    """
    shares = np.mean(np.hstack([system.used for system in systems]), axis=1)
    few = [name for name, share in zip(arm.joint_names, shares, strict=True) if share < FEWEST]
    if few:
        warn_user(
            f"{', '.join(few)} stick or shake in nearly all of the logs, where dry friction can be "
            "anything: their parameters stay as in the file; let them move smoothly, and in long "
            "strokes",
            LogWarning,
        )


def warn_of_little(rows: Sequence[IdentifiedParameter]) -> None:
    """Warn where most base parameters are hardly better known than before.

    Warns:
        LogWarning: how many the log tells.
    """
    told = sum(row.known for row in rows)
    if told < LEAST_TOLD * len(rows):
        warn_user(
            f"too little motion: the logs tell {told} of {len(rows)} base parameters, the others "
            "stay near the file's; move farther and faster, as references.Excitation does",
            LogWarning,
        )


def _demand_units(arm: Arm, entry: ReadLog) -> None:
    """Refuse degrees."""
    x = np.concatenate([piece.x for piece in entry.pieces])
    v = np.concatenate([piece.v for piece in entry.pieces])
    turns = np.array([unit == "rad" for unit in arm.position_units])
    furthest = np.maximum(np.abs(arm.lower_position_limit), np.abs(arm.upper_position_limit))
    ends = np.where(np.isfinite(furthest), furthest, 4.0 * np.pi)
    far = turns & (np.max(np.abs(x), axis=0) > BEYOND * ends)
    fast = turns & (np.percentile(np.abs(v), 95, axis=0) > TOO_FAST * arm.velocity_limit)
    if np.any(far | fast):
        j = int(np.argmax(far | fast))
        low, high, speed = x[:, j].min(), x[:, j].max(), np.max(np.abs(v[:, j]))
        raise LogError(
            "degrees",
            f"{entry.log.label}: positions look like degrees: {arm.joint_names[j]} goes from "
            f"{low:.4g} to {high:.4g} at up to {speed:.4g} per second, far beyond the arm's limits "
            "in radians; multiply the columns by π/180",
        )


def _demand_motion(arm: Arm, entry: ReadLog) -> None:
    """Refuse a log in which hardly anything moves."""
    x = np.concatenate([piece.x for piece in entry.pieces])
    idle = np.ptp(x, axis=0) < LEAST_TRAVEL
    names = ", ".join(name for name, rests in zip(arm.joint_names, idle, strict=True) if rests)
    if np.count_nonzero(idle) > 0.5 * arm.nv:
        raise LogError(
            "motion",
            f"{entry.log.label}: too little motion: {names} moved by less than {LEAST_TRAVEL:g} "
            "rad or m; move every joint, quickly and far, as references.Excitation does",
        )
    if np.any(idle):
        warn_user(
            f"{entry.log.label}: too little motion of {names}: what these joints alone would show "
            "stays as in the file",
            LogWarning,
        )


def _demand_velocities(arm: Arm, entry: ReadLog) -> None:
    """Refuse velocity columns that are not those of the positions."""
    if entry.log.v is None:
        return
    ours = np.concatenate([piece.v for piece in entry.pieces])
    theirs = np.concatenate(
        [
            np.column_stack([np.interp(piece.t, entry.log.t, column) for column in entry.log.v.T])
            for piece in entry.pieces
        ]
    )
    swing = np.sqrt(np.mean(ours**2, axis=0))
    moving = np.flatnonzero(swing > 1e-2 * swing.max())
    slopes = np.sum(ours * theirs, axis=0) / np.maximum(np.sum(ours**2, axis=0), 1e-300)
    for j in moving:
        name, left = arm.joint_names[j], theirs[:, j] - ours[:, j]
        if np.sqrt(np.mean(left**2)) < UNLIKE * swing[j]:
            continue
        likeness = [_likeness(theirs[:, j], ours[:, k]) for k in range(arm.nv)]
        if likeness[j] > NOISY and abs(slopes[j] - 1.0) < UNLIKE:
            continue
        k = int(np.argmax(np.abs(likeness)))
        where = f"{entry.log.label}: the velocity of {name}"
        if abs(likeness[k]) > 0.95 and k != j:
            raise LogError(
                "columns",
                f"{where} is that of the position of {arm.joint_names[k]}: columns are swapped; "
                "name them in their order",
            )
        for factor, meaning in (
            (1.0 / DEGREE, "is in degrees per second while its position is in radians"),
            (DEGREE, "is in radians per second while its position is in degrees"),
            (-1.0, "has the opposite sign of its position's"),
        ):
            if likeness[j] * np.sign(factor) > 0.95 and abs(slopes[j] / factor - 1.0) < 0.2:
                kind = "sign" if factor < 0.0 else "degrees"
                raise LogError(kind, f"{where} {meaning}; bring both to rad and rad/s")
        raise LogError(
            "columns",
            f"{where} is not the derivative of its position (slope {slopes[j]:.3g}, correlation "
            f"{likeness[j]:.2f}): columns are swapped, or one is something else",
        )


def _likeness(a: Array, b: Array) -> float:
    return float(a @ b / max(float(np.sqrt((a @ a) * (b @ b))), 1e-300))


def _demand_best_explanation(arm: Arm, entry: ReadLog) -> None:
    """Refuse a log that another reading explains much better."""
    explain = Explanations(arm, sample(entry.pieces))
    as_is, others = explain.as_is(), list(explain.others())
    believed = [
        reading
        for reading in others
        if as_is - reading[0] > max(SHARES.get(reading[1], BETTER) * as_is, AT_LEAST)
    ]
    if believed:
        # Of readings that are nearly as good the first, which is the plainest.
        best = min(reading[0] for reading in believed)
        near = best + min(ALIKE * (as_is - best), AT_LEAST / 2.0)
        best, kind, words = next(reading for reading in believed if reading[0] <= near)
        raise LogError(
            kind,
            f"{entry.log.label}: {words} (explained so, the torque's misfit is "
            f"{best / explain.rows:.2g} per equation, as it stands {as_is / explain.rows:.2g})",
        )
