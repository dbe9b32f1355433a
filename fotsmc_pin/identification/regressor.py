"""The equation of motion as a table that is linear in what is unknown: `τ = X θ`.

Per joint's row: ten dynamic parameters of each body (Pinocchio's order: mass, first moments,
`Ixx Ixy Iyy Ixz Iyz Izz` about the joint's origin), then of each joint its armature, viscous and
Coulomb friction, and where they are asked for a constant offset and what friction at standstill
exceeds Coulomb friction by.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from scipy.signal import savgol_filter

from fotsmc_pin.identification.filtering import (
    ORDER,
    averaging,
    averaging_times,
    configurations,
    half_window,
)

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.filtering import Piece
    from fotsmc_pin.types import Array

COARSE = 0.2
"""Step at which the bodies' columns are evaluated, over the width of the average."""
SLACK = 0.1
"""Room that the averages leave for a shift of the torque in time [s]."""
STILL = 2e-3
"""Speed below which a joint may stick [rad/s, m/s]."""
PASSING = 0.5
"""Of the speed that a joint gains in half a window, below which it may stick too."""
MOSTLY_STILL = 0.03
"""Share of an average in which a joint may stick before its row is left out."""
BLOCK = 500
"""Averages that are worked out at once."""


class Parameters:
    """The order of the unknowns of an arm of `n` joints, `p` of them.

    Attributes:
        groups: place of each group, by name.
        own: groups of which each joint's row knows one.
    """

    def __init__(self, joints: int, *, offset: bool = False, stribeck: bool = False) -> None:
        self.joints = joints
        self.own = ["armature", "damping", "friction"]
        self.own += ["offset"] if offset else []
        self.own += ["stribeck"] if stribeck else []
        self.groups = {"bodies": slice(0, 10 * joints)}
        for k, name in enumerate(self.own):
            self.groups[name] = slice((10 + k) * joints, (11 + k) * joints)
        self.size = (10 + len(self.own)) * joints

    def body(self, number: int) -> slice:
        """Return the place of a body's ten parameters, from 0."""
        return slice(10 * number, 10 * number + 10)


@dataclass(frozen=True, kw_only=True, eq=False)
class Equations:
    """Averaged equations of one piece of a log, `N` of each joint.

    Attributes:
        piece: where they come from.
        width: standard deviation of the average [s].
        times: of the averages (N,) [s].
        table: `X` (nv, N, p).
        used: whether a joint's row counts (nv, N); not where it stuck.
    """

    piece: Piece
    width: float
    times: Array
    table: Array
    used: np.ndarray

    def torque(self, shift: float = 0.0) -> Array:
        """Return the averaged torque (nv, N) that was recorded `shift` [s] after the motion."""
        matrix = averaging(self.times + shift, self.piece.t, self.width)
        return np.asarray((matrix @ self.piece.tau).T)


def equations(
    arm: Arm, piece: Piece, parameters: Parameters, width: float, stribeck_velocity: float
) -> Equations:
    """Return the averaged equations of a piece."""
    times = averaging_times(piece, width, SLACK)
    n, p = arm.nv, parameters.size
    table = np.zeros((n, len(times), p))
    stride = max(1, int(COARSE * width / piece.dt))
    coarse = piece.t[::stride]
    for start in range(0, len(times), BLOCK):
        block = slice(start, start + BLOCK)
        first, last = np.searchsorted(
            coarse, (times[block][0] - 5.0 * width, times[block][-1] + 5.0 * width)
        )
        rows = slice(max(first - 1, 0) * stride, (last + 1) * stride, stride)
        bodies = body_columns(arm, piece.x[rows], piece.v[rows], piece.a[rows])
        matrix = averaging(times[block], piece.t[rows], width)
        averaged = matrix @ bodies.reshape(len(bodies), -1)
        table[:, block, : 10 * n] = averaged.reshape(-1, n, 10 * n).transpose(1, 0, 2)
    matrix = averaging(times, piece.t, width)
    own = own_columns(piece, stribeck_velocity)
    for name in parameters.own:
        averaged = matrix @ own[name]
        for j in range(n):
            table[j, :, parameters.groups[name].start + j] = averaged[:, j]
    resting = matrix @ at_rest(piece).astype(float)
    return Equations(
        piece=piece, width=width, times=times, table=table, used=(resting < MOSTLY_STILL).T
    )


def body_columns(arm: Arm, x: Array, v: Array, a: Array) -> Array:
    """Return the torque per unit of each body's parameters (T, nv, 10 nv)."""
    model, data = arm.model, arm.model.createData()
    found = np.empty((len(x), arm.nv, 10 * arm.nv))
    for row, (q, speed, gain) in enumerate(zip(configurations(arm, x), v, a, strict=True)):
        found[row] = pin.computeJointTorqueRegressor(model, data, q, speed, gain)
    return found


def own_columns(piece: Piece, stribeck_velocity: Array | float) -> dict[str, Array]:
    """Return the torque per unit of each joint's own parameters, each (T, nv)."""
    sign = np.sign(piece.v)
    kinked = {
        "friction": sign,
        "stribeck": sign * np.exp(-((piece.v / stribeck_velocity) ** 2)),
    }
    half = half_window(piece.dt)
    return {
        "armature": piece.a,
        "damping": piece.v,
        "offset": np.ones_like(piece.v),
        # What jumps is smoothed like the torque; the others are smooth already.
        **{name: savgol_filter(x, 2 * half + 1, ORDER, axis=0) for name, x in kinked.items()},
    }


def at_rest(piece: Piece) -> np.ndarray:
    """Return whether each joint may stick at each sample (T, nv): friction is anything then.

    A joint that turns round sticks for a while. The smoothed velocity does not show that as zero:
    it runs through the speeds that the joint has within a window before and after.
    """
    passing = half_window(piece.dt) * piece.dt * np.sqrt(np.mean(piece.a**2, axis=0))
    least = STILL + 5.0 * velocity_noise(piece) + PASSING * passing
    return np.asarray(np.abs(piece.v) < least)


def velocity_noise(piece: Piece) -> Array:
    """Return the standard deviation of the smoothed velocity (nv,)."""
    half = half_window(piece.dt)
    # Slope of a least-squares polynomial of degree five through 2 half + 1 samples.
    gain = 5.0 * np.sqrt(0.4) / (half * np.sqrt(2.0 * half))
    return np.asarray(gain * piece.position_noise / piece.dt)
