"""Ways to read a log: each with the misfit of the best arm near the nominal one."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from fotsmc_pin.arms.mounting import rotation_to_down
from fotsmc_pin.identification.filtering import averaging, configurations
from fotsmc_pin.identification.prior import nominal_belief
from fotsmc_pin.identification.regressor import MOSTLY_STILL, Parameters, at_rest, own_columns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.filtering import Piece
    from fotsmc_pin.types import Array

SAMPLES = 150
"""Of a log, on which the explanations are compared."""
WIDTH = 0.03
"""Standard deviation of the weight by which samples are averaged [s]."""
TOLERANCE = 0.03
"""Error of the torque that an explanation may leave, over the swing of the torque."""
FEWEST = 0.2
"""Share of its equations that a joint must have left: it neither sticks nor shakes."""
LINKS = 0.2
"""Standard deviation of a link's mass over its nominal one, here where the file is to judge."""
DIRECTIONS = 40
"""From which gravity is tried to come."""
SEARCH: Any = {
    "maxfev": 60,
    "xatol": 5e-3,
    "fatol": 1.0,
    "initial_simplex": np.array([[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]]),
}
"""How such a direction is refined by tilting it [rad]."""
QUIET = 0.2
"""Misfit per equation that leaves nothing for a slightly other direction of gravity to explain."""
TILT = 0.05
"""Angle between two directions of gravity that counts [rad]."""


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


def sample(pieces: tuple[Piece, ...]) -> Sample:
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


class Explanations:
    """Ways to read a log, each with the misfit of the best arm near the nominal one."""

    def __init__(self, arm: Arm, sample: Sample) -> None:
        self.arm, self.sample, self.n = arm, sample, arm.nv
        self.parameters = Parameters(arm.nv)
        belief = nominal_belief(arm, self.parameters, links=LINKS)
        self.mean, self.factor = belief.mean.copy(), np.linalg.cholesky(belief.covariance)
        # Rotors and friction are not negative, by which a wrong sign is known: some are expected.
        own = slice(10 * arm.nv, self.parameters.size)
        self.mean[own] = np.maximum(self.mean[own], np.sqrt(np.diag(belief.covariance)[own]))
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
        # A joint without equations would fit anything.
        moving = np.flatnonzero(self.sample.moves.mean(axis=0) >= FEWEST).tolist()
        for j, k in combinations(moving, 2):
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
        misfit, way = min((self.refined(size * start) for start in starts), key=_first)
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

        def misfit(tilt: Array) -> float:
            return self.with_gravity(way(tilt))

        found = minimize(misfit, np.zeros(2), method="Nelder-Mead", options=SEARCH)
        return float(found.fun), way(found.x)

    def with_gravity(self, gravity: Array) -> float:
        """Return the misfit of the log with gravity from elsewhere."""
        return _Solver(self, self.whole(gravity)).misfit(self.sample.tau)

    def to_base(self, gravity: Array) -> Array:
        """Return gravity in the frame of the base, which the file may have turned already."""
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


def _first(pair: tuple[float, Array]) -> float:
    return pair[0]


def directions(count: int) -> Array:
    """Return unit vectors (count + 6, 3): on Fibonacci's spiral, and along the axes."""
    k = np.arange(count) + 0.5
    height, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    flat = np.sqrt(1.0 - height**2)
    spiral = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])
    return np.vstack([spiral, np.eye(3), -np.eye(3)])


class _Solver:
    """The fit of any torque to one regressor, with its misfit."""

    def __init__(self, of: Explanations, table: Array, swap: np.ndarray | None = None) -> None:
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
