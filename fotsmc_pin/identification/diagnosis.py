"""What is wrong with a log: named before anything is fitted to it.

Plain mistakes show in the numbers of one column: degrees in the place of radians, velocities that are
not those of the positions, a joint that rests. The others show when the log is explained in several
ways: as it stands, with one torque's sign turned, with two columns exchanged, with gravity elsewhere
or left out. Each explanation is fitted to a few hundred samples, with the same trust in the nominal
arm; where another one explains the log much better than as it stands, the log is refused by that name.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from fotsmc_pin.errors import LogError
from fotsmc_pin.identification.filtering import averaging, configurations
from fotsmc_pin.identification.prior import nominal_belief
from fotsmc_pin.identification.regressor import MOSTLY_STILL, Parameters, at_rest, own_columns
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.filtering import Piece
    from fotsmc_pin.identification.reading import ReadLog
    from fotsmc_pin.types import Array

SAMPLES = 200
"""Of a log, on which the explanations are compared."""
WIDTH = 0.03
"""Standard deviation of the weight by which samples are averaged [s]."""
TOLERANCE = 0.03
"""Error of the torque that an explanation may leave, over the swing of the torque."""
BETTER, AT_LEAST = 0.1, 25.0
"""Decrease of the misfit, which is a χ², by which another explanation is believed: its share of the
misfit of the log as it stands, and at the least."""
PLAIN = 0.02
"""That share for a wrong sign and for torque without gravity, which explain a right log far worse."""
LINKS = 0.2
"""Standard deviation of a link's mass over its nominal one, here where the file is to judge."""
DIRECTIONS = 40
"""From which gravity is tried to come."""
QUIET = 0.2
"""Misfit per equation that leaves nothing for a slightly other direction of gravity to explain."""
TILT = 0.05
"""Angle between two directions of gravity that counts [rad]."""
BEYOND = 3.0
"""Positions over the limits, from which on they are not radians."""
TOO_FAST = 8.0
"""Speed over the velocity limit, from which on positions are not radians."""
DEGREE = np.pi / 180.0
UNLIKE = 0.3
"""Part of a velocity column that the positions may leave unexplained."""
LEAST_TRAVEL = 0.02
"""Travel of a joint below which it tells nothing [rad, m]."""


class LogWarning(UserWarning):
    """A log tells less than it could."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Some instants of a log (M, nv): `sign` is that of the velocity, averaged like the torque."""

    x: Array
    v: Array
    a: Array
    tau: Array
    sign: Array
    moves: np.ndarray
    noise: Array


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
            f"{entry.log.label}: positions look like degrees: {arm.joint_names[j]} goes from {low:.4g} "
            f"to {high:.4g} at up to {speed:.4g} per second, far beyond the arm's limits in radians; "
            "multiply the columns by π/180",
        )


def _demand_motion(arm: Arm, entry: ReadLog) -> None:
    """Refuse a log in which hardly anything moves."""
    x = np.concatenate([piece.x for piece in entry.pieces])
    idle = np.ptp(x, axis=0) < LEAST_TRAVEL
    names = ", ".join(name for name, rests in zip(arm.joint_names, idle, strict=True) if rests)
    if np.count_nonzero(idle) > 0.5 * arm.nv:
        raise LogError(
            "motion",
            f"{entry.log.label}: too little motion: {names} moved by less than {LEAST_TRAVEL:g} rad "
            "or m; move every joint, quickly and far: references.Excitation makes such a motion",
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
        k = int(np.argmax(np.abs(likeness)))
        where = f"{entry.log.label}: the velocity of {name}"
        if abs(likeness[k]) > 0.95 and k != j:
            raise LogError(
                "columns",
                f"{where} is that of the position of {arm.joint_names[k]}: columns are swapped; "
                "name them in their order",
            )
        for factor, words in (
            (1.0 / DEGREE, "is in degrees per second while its position is in radians"),
            (DEGREE, "is in radians per second while its position is in degrees"),
            (-1.0, "has the opposite sign of its position's"),
        ):
            if likeness[j] * np.sign(factor) > 0.95 and abs(slopes[j] / factor - 1.0) < 0.2:
                kind = "sign" if factor < 0.0 else "degrees"
                raise LogError(kind, f"{where} {words}; bring both to rad and rad/s")
        raise LogError(
            "columns",
            f"{where} is not the derivative of its position (slope {slopes[j]:.3g}, correlation "
            f"{likeness[j]:.2f}): columns are swapped, or one is something else",
        )


def _likeness(a: Array, b: Array) -> float:
    return float(a @ b / max(np.sqrt((a @ a) * (b @ b)), 1e-300))


def _demand_best_explanation(arm: Arm, entry: ReadLog) -> None:
    """Refuse a log that another reading explains much better."""
    explain = _Explanations(arm, _sample(entry.pieces))
    as_is, others = explain.as_is(), list(explain.others())
    believed = [
        (misfit, kind, words)
        for misfit, kind, words in others
        if as_is - misfit
        > max((PLAIN if kind in ("sign", "gravity-free") else BETTER) * as_is, AT_LEAST)
    ]
    if believed:
        # Of readings that are nearly as good the first, which is the plainest.
        best = min(misfit for misfit, _, _ in believed)
        near = best + 0.1 * (as_is - best)
        best, kind, words = next(reading for reading in believed if reading[0] <= near)
        raise LogError(
            kind,
            f"{entry.log.label}: {words} (explained so, the torque's misfit is "
            f"{best / explain.rows:.2g} per equation, as it stands {as_is / explain.rows:.2g})",
        )


def _sample(pieces: tuple[Piece, ...]) -> Sample:
    """Return averages of a log, evenly spread."""
    spacing = sum(piece.t[-1] - piece.t[0] for piece in pieces) / SAMPLES
    parts = []
    for piece in pieces:
        width = max(WIDTH, 2.5 * piece.dt)
        times = np.arange(piece.t[0] + 4.0 * width, piece.t[-1] - 4.0 * width, spacing)
        matrix = averaging(times, piece.t, width)
        noise = np.sqrt(np.mean((piece.raw_tau - piece.tau) ** 2, axis=0))
        noise *= np.sqrt(piece.dt / (2.0 * np.sqrt(np.pi) * width))
        resting = at_rest(piece).astype(float)
        own = own_columns(piece, 1.0)
        tables = (piece.x, piece.v, piece.a, piece.tau, resting, own["friction"])
        parts.append((*(matrix @ table for table in tables), np.tile(noise, (len(times), 1))))
    x, v, a, tau, resting, sign, noise = (
        np.concatenate(tables) for tables in zip(*parts, strict=True)
    )
    return Sample(
        x=x,
        v=v,
        a=a,
        tau=tau,
        sign=sign,
        moves=resting < MOSTLY_STILL,
        noise=np.sqrt(np.mean(noise**2, axis=0)),
    )


class _Explanations:
    """Ways to read a log, each with the misfit of the best arm near the nominal one."""

    def __init__(self, arm: Arm, sample: Sample) -> None:
        self.arm, self.sample, self.n = arm, sample, arm.nv
        self.parameters = Parameters(arm.nv)
        belief = nominal_belief(arm, self.parameters, links=LINKS)
        self.mean, self.factor = belief.mean, np.linalg.cholesky(belief.covariance)
        swing = np.std(sample.tau, axis=0)
        self.noise = np.hypot(sample.noise, TOLERANCE * np.maximum(swing, 0.05 * swing.max()))
        self.rows = sample.tau.size
        self.down = np.array(arm.model.gravity.linear)
        self.still = self.table(np.zeros(3), sample.x, sample.v, sample.a)
        self.by_axis = [
            self.table(axis, sample.x, 0.0 * sample.v, 0.0 * sample.a) for axis in np.eye(3)
        ]
        self.columns = {"armature": sample.a, "damping": sample.v, "friction": sample.sign}

    def as_is(self) -> float:
        """Return the misfit of the log as it stands."""
        self.plain = _Solver(self, self.whole(self.down))
        return self.plain.misfit(self.sample.tau)

    def others(self) -> Iterator[tuple[float, str, str]]:
        """Yield the misfit of each other reading, its kind and its name in words."""
        tau, names = self.sample.tau, self.arm.joint_names
        yield (
            self.plain.misfit(-tau),
            "sign",
            "the torque of all joints has the wrong sign; it should be what the motors do to the "
            "arm: turn the sign of its columns",
        )
        for j, name in enumerate(names):
            turned = tau.copy()
            turned[:, j] *= -1.0
            yield (
                self.plain.misfit(turned),
                "sign",
                f"the torque of {name} has the wrong sign; turn the sign of its column",
            )
        yield from self.of_gravity()
        for j, k in combinations(range(self.n), 2):
            swap = np.arange(self.n)
            swap[[j, k]] = k, j
            both = f"{names[j]} and {names[k]}"
            yield (
                self.plain.misfit(tau[:, swap]),
                "columns",
                f"the torque columns of {both} are swapped",
            )
            moved = _Solver(self, self.reordered(swap), swap)
            yield (
                moved.misfit(tau),
                "columns",
                f"the position columns of {both} are swapped, or their torque columns",
            )
            yield moved.misfit(tau[:, swap]), "columns", f"the columns of {both} are swapped"

    def of_gravity(self) -> Iterator[tuple[float, str, str]]:
        """Yield the readings without gravity, and with gravity from elsewhere."""
        size = float(np.linalg.norm(self.down))
        if size == 0.0:
            return
        free = (
            "the torque seems to be without gravity, which many robots add themselves; say so with "
            'compensates=("gravity",), or record the total torque'
        )
        added = np.array([self.arm.gravity(q) for q in configurations(self.arm, self.sample.x)])
        yield self.plain.misfit(self.sample.tau + added), "gravity-free", free
        # A robot that knows its own weight well leaves nothing of it.
        yield _Solver(self, self.whole(np.zeros(3))).misfit(self.sample.tau), "gravity-free", free
        units = directions(DIRECTIONS)
        misfits = [self.with_gravity(size * unit) for unit in units]
        if self.plain.misfit(self.sample.tau) < min(QUIET * self.rows, *misfits):
            return
        starts = units[np.argsort(misfits)[:3]]
        misfit, way = min(
            (self.refined(size * start) for start in starts), key=lambda pair: pair[0]
        )
        if way @ self.down > size**2 * np.cos(TILT):
            return
        turn = self.to_base(way)
        yield (
            misfit,
            "gravity",
            f"gravity comes from another direction than the arm's file has it: about "
            f"({turn[0]:.1f}, {turn[1]:.1f}, {turn[2]:.1f}) m/s² in the frame of the base; give "
            "load_arm(..., gravity=...) how the arm is mounted",
        )

    def refined(self, start: Array) -> tuple[float, Array]:
        """Return the least misfit with gravity from near `start`, and that gravity (3,)."""
        size = float(np.linalg.norm(start))
        across = size * np.linalg.svd(start[None])[2][1:]

        def way(tilt: Array) -> Array:
            leant = start + tilt @ across
            return np.asarray(size * leant / np.linalg.norm(leant))

        found = minimize(
            lambda tilt: self.with_gravity(way(tilt)),
            np.zeros(2),
            method="Nelder-Mead",
            options={
                "maxfev": 60,
                "xatol": 5e-3,
                "fatol": 1.0,
                "initial_simplex": [[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]],
            },
        )
        return float(found.fun), way(found.x)

    def with_gravity(self, gravity: Array) -> float:
        """Return the misfit of the log with gravity from elsewhere."""
        return _Solver(self, self.whole(gravity)).misfit(self.sample.tau)

    def to_base(self, gravity: Array) -> Array:
        """Return gravity in the frame of the base, which the file may have turned already."""
        from fotsmc_pin.arms.mounting import rotation_to_down

        return np.asarray(rotation_to_down(self.arm.base_gravity).T @ gravity)

    def whole(self, gravity: Array) -> Array:
        """Return the regressor (nv, M, p) with any gravity: it is linear in it."""
        bodies = self.still + sum(
            part * table for part, table in zip(gravity, self.by_axis, strict=True)
        )
        return self.complete(bodies, self.columns)

    def complete(self, bodies: Array, own: dict[str, Array]) -> Array:
        """Return the regressor (nv, M, p) of bodies' columns (M, nv, 10 nv) and joints' own."""
        table = np.zeros((self.n, len(bodies), self.parameters.size))
        table[:, :, : 10 * self.n] = bodies.transpose(1, 0, 2)
        for name in self.parameters.own:
            for j in range(self.n):
                table[j, :, self.parameters.groups[name].start + j] = own[name][:, j]
        return table

    def reordered(self, swap: np.ndarray) -> Array:
        """Return the regressor with the positions of two joints exchanged."""
        s = self.sample
        bodies = self.table(self.down, s.x[:, swap], s.v[:, swap], s.a[:, swap])
        return self.complete(bodies, {name: x[:, swap] for name, x in self.columns.items()})

    def table(self, gravity: Array, x: Array, v: Array, a: Array) -> Array:
        """Return the bodies' columns (M, nv, 10 nv) under some gravity."""
        model = pin.Model(self.arm.model)
        model.gravity.linear = np.array(gravity)
        data = model.createData()
        found = np.empty((len(x), self.n, 10 * self.n))
        for row, (q, speed, gain) in enumerate(zip(configurations(self.arm, x), v, a, strict=True)):
            found[row] = pin.computeJointTorqueRegressor(model, data, q, speed, gain)
        return found


def directions(count: int) -> Array:
    """Return unit vectors (count + 6, 3): on Fibonacci's spiral, and along the axes."""
    k = np.arange(count) + 0.5
    height, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    flat = np.sqrt(1.0 - height**2)
    spiral = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])
    return np.vstack([spiral, np.eye(3), -np.eye(3)])


class _Solver:
    """The fit of any torque to one regressor, with its misfit."""

    def __init__(self, of: _Explanations, table: Array, swap: np.ndarray | None = None) -> None:
        moves = of.sample.moves if swap is None else of.sample.moves[:, swap]
        # A joint that may stick has no row.
        self.weight = moves / of.noise
        scaled = table * self.weight.T[:, :, None]
        self.rows = (scaled @ of.factor).reshape(-1, of.mean.size)
        self.mean = (scaled @ of.mean).ravel()
        self.factored = cho_factor(np.eye(of.mean.size) + self.rows.T @ self.rows)

    def misfit(self, tau: Array) -> float:
        """Return what the best arm leaves of the torque, and how far it is from the nominal one."""
        wanted = (tau * self.weight).T.ravel() - self.mean
        right = self.rows.T @ wanted
        return float(wanted @ wanted - right @ cho_solve(self.factored, right))
