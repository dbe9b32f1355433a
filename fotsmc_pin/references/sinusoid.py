"""`Sinusoid`: every joint swings around a centre, starting from rest."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.checks import finite_number, finite_vector
from fotsmc_pin.compiled import kernel, specialized
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references.limits import broken_limits

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


PEAK_FADE = 15.0 / 8.0  # Largest slope of the fade-in of unit length.


@dataclass(frozen=True, kw_only=True, eq=False)
class Sinusoid:
    """Sinusoids in every joint, faded in from rest.

    `x(t) = center + f(t) · amplitude ∘ sin(ω t)` with `ω = 2π / period` and a fade-in `f` that
    rises from 0 to 1 over `ramp` seconds by the quintic `10 u³ - 15 u⁴ + 6 u⁵`, so that position,
    velocity and acceleration start at the centre and at zero and stay continuous.

    Attributes:
        arm: the arm that it is for.
        center: configuration to swing around, (nq,).
        amplitude: of each joint, (nv,) [rad or m].
        period: of each joint, (nv,) [s].
        ramp: length of the fade-in [s]; 0 starts at full speed.
    """

    arm: Arm
    center: Array
    amplitude: Array
    period: Array
    ramp: float = 2.0
    _table: Array = field(init=False, repr=False)
    _plain: bool = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Check the arm and the numbers."""
        demand_arm(self.arm)
        nv = self.arm.nv
        object.__setattr__(self, "center", finite_vector("center", self.center, self.arm.nq))
        object.__setattr__(self, "amplitude", finite_vector("amplitude", self.amplitude, nv))
        period = finite_vector("period", np.broadcast_to(self.period, (nv,)), nv)
        for value in period:
            finite_number("period", value, above=0.0)
        object.__setattr__(self, "period", period)
        object.__setattr__(self, "ramp", finite_number("ramp", self.ramp, at_least=0.0))
        plain = self.arm.is_euclidean
        middle = self.center if plain else np.zeros(nv)
        table = np.array([middle, self.amplitude, 2.0 * np.pi / period])
        object.__setattr__(self, "_table", table)
        object.__setattr__(self, "_plain", plain)
        swing_code()  # Compiled now, so that the first call takes no longer than the others.

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s], all fresh arrays."""
        table = self._table
        motion = np.empty(table.shape)
        swing_code()(t, self.ramp, table, motion)
        if self._plain:
            return motion[0], motion[1], motion[2]
        return self.arm.integrate(self.center, motion[0]), motion[1], motion[2]

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return `q_d` (N, nq), `v_d` and `a_d` (N, nv) at the times `t` (N,) [s]."""
        motion = np.empty((len(t), *self._table.shape))
        swing_many(np.asarray(t, dtype=np.float64), self.ramp, self._table, motion)
        x, v_d, a_d = (np.ascontiguousarray(motion[:, order]) for order in range(3))
        if self._plain:
            return x, v_d, a_d
        return np.array([self.arm.integrate(self.center, row) for row in x]), v_d, a_d

    @classmethod
    def inside_limits(
        cls,
        arm: Arm,
        *,
        center: ArrayLike | None = None,
        amplitude: float = 0.3,
        period: float = 4.0,
        fraction: float = 0.5,
        ramp: float = 2.0,
    ) -> Sinusoid:
        """Return sinusoids that stay inside the arm's position, velocity and effort limits.

        The amplitude of each joint is `amplitude`, reduced where the distance to the nearest
        position limit or the velocity limit requires it. As long as the effort that the model needs
        exceeds `fraction` of a limit, all amplitudes are reduced together.

        Args:
            arm: the arm.
            center: configuration to swing around, (nq,); by default `arm.neutral` moved off the
                limits; where gravity there needs most of the effort allowed, the nearest of a
                fixed set of random configurations that is easier to hold.
            amplitude: largest amplitude [rad or m].
            period: of the first joint [s]; each after it is 12 % of this longer than the last.
            fraction: share of the velocity and effort limits that may be used, in (0, 1].
            ramp: length of the fade-in [s].

        Raises:
            ArgumentError: the effort limits do not even hold the arm still at the centre.
        """
        demand_arm(arm)
        finite_number("amplitude", amplitude, above=0.0)
        finite_number("period", period, above=0.0)
        finite_number("fraction", fraction, above=0.0, at_most=1.0)
        if center is None:
            x = _easy_center(arm, amplitude, fraction)
        else:
            x = arm.to_joint_positions(finite_vector("center", center, arm.nq))
        room = np.minimum(x - arm.lower_position_limit, arm.upper_position_limit - x)
        periods = np.asarray(period * (1.0 + 0.12 * np.arange(arm.nv)))
        fade_speed = PEAK_FADE / ramp if ramp > 0.0 else 0.0
        speed = 2.0 * np.pi / periods + fade_speed
        amplitudes = np.minimum(amplitude, 0.9 * np.maximum(room, 0.0))
        amplitudes = np.minimum(amplitudes, fraction * arm.velocity_limit / speed)
        for _ in range(12):
            reference = cls(
                arm=arm,
                center=arm.from_joint_positions(x),
                amplitude=amplitudes,
                period=periods,
                ramp=ramp,
            )
            broken = broken_limits(
                arm,
                reference,
                duration=ramp + 2.0 * float(periods.max()),
                samples=200,
                effort_share=fraction,
            )
            if not broken:
                return reference
            amplitudes = 0.7 * amplitudes
        raise ArgumentError(
            "center", center, f"even near it the arm asks for too much: {broken[0]}"
        )


def _easy_center(arm: Arm, amplitude: float, fraction: float) -> Array:
    """Return joint positions, (nv,), away from the limits and with little gravity load."""
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    half = np.where(np.isfinite(lower) & np.isfinite(upper), 0.5 * (upper - lower), np.inf)
    room = np.minimum(amplitude, half)

    def clear(q: Array) -> Array:
        return np.clip(arm.to_joint_positions(q), lower + room, upper - room)

    def load(x: Array) -> float:
        return float(np.max(np.abs(arm.gravity(arm.from_joint_positions(x))) / arm.effort_limit))

    first = clear(arm.neutral)
    if load(first) <= 0.8 * fraction:
        return first
    rng = np.random.default_rng(0)
    others = [clear(arm.random_configuration(rng)) for _ in range(200)]
    easy = [x for x in others if load(x) <= 0.5 * fraction]
    if easy:
        return min(easy, key=lambda x: float(np.linalg.norm(x - first)))
    return min((first, *others), key=load)


@cache
def swing_code() -> Any:
    """Return the machine code of `swing`, which skips the look-up of types at each call."""
    return specialized(swing, 0.0, 0.0, np.zeros((3, 1)), np.zeros((3, 1)))


@kernel
def swing(t: float, ramp: float, table: Array, motion: Array) -> None:
    """Write position, velocity and acceleration at time `t` into `motion` (3, nv).

    The rows of `table` (3, nv) are centre, amplitude and frequency [rad/s].
    """
    f, fd, fdd = fade_in(t, ramp)
    for j in range(table.shape[1]):
        amplitude, w = table[1, j], table[2, j]
        sine, cosine = math.sin(w * t), math.cos(w * t)
        motion[0, j] = table[0, j] + amplitude * f * sine
        motion[1, j] = amplitude * (fd * sine + f * w * cosine)
        motion[2, j] = amplitude * (fdd * sine + 2.0 * fd * w * cosine - f * w**2 * sine)


@kernel
def swing_many(t: Array, ramp: float, table: Array, motion: Array) -> None:
    """Write what `swing` does at the times `t` (N,) into `motion` (N, 3, nv)."""
    for k in range(t.size):
        swing(t[k], ramp, table, motion[k])


@kernel
def fade_in(t: float, ramp: float) -> tuple[float, float, float]:
    """Return the fade-in and its first two derivatives."""
    if t >= ramp:
        return 1.0, 0.0, 0.0
    u = max(t, 0.0) / ramp
    return (
        u**3 * (10.0 - 15.0 * u + 6.0 * u**2),
        30.0 * u**2 * (1.0 - u) ** 2 / ramp,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / ramp**2,
    )
