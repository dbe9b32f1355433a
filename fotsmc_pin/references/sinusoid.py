"""`Sinusoid`: every joint swings around a centre, starting from rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.checks import finite_number, finite_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fotsmc_pin.arms import Arm

    Vector = NDArray[np.float64]


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
    center: Vector
    amplitude: Vector
    period: Vector
    ramp: float = 2.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        nv = self.arm.nv
        object.__setattr__(self, "center", finite_vector("center", self.center, self.arm.nq))
        object.__setattr__(self, "amplitude", finite_vector("amplitude", self.amplitude, nv))
        period = finite_vector("period", np.broadcast_to(self.period, (nv,)), nv)
        for value in period:
            finite_number("period", value, above=0.0)
        object.__setattr__(self, "period", period)
        finite_number("ramp", self.ramp, at_least=0.0)

    def __call__(self, t: float) -> tuple[Vector, Vector, Vector]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s], all fresh arrays."""
        omega = 2.0 * np.pi / self.period
        sine, cosine = np.sin(omega * t), np.cos(omega * t)
        f, fd, fdd = _fade_in(t, self.ramp)
        x = self.amplitude * f * sine
        v = self.amplitude * (fd * sine + f * omega * cosine)
        a = self.amplitude * (fdd * sine + 2.0 * fd * omega * cosine - f * omega**2 * sine)
        return self.arm.integrate(self.center, x), v, a

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

        The amplitude of each joint is `amplitude`, made smaller where the room to the nearest
        position limit, or the speed limit, asks for it. While the model's effort on the way
        exceeds `fraction` of a limit by more than holding still at the centre does, the periods
        are lengthened.

        Args:
            arm: the arm.
            center: configuration to swing around, (nq,); by default `arm.neutral`, moved to
                mid-range where that lies closer to a limit than `amplitude`.
            amplitude: largest amplitude [rad or m].
            period: of the first joint [s]; those after it are a little longer, each its own.
            fraction: share of the velocity and effort limits that may be used, in (0, 1].
            ramp: length of the fade-in [s].
        """
        finite_number("amplitude", amplitude, above=0.0)
        finite_number("period", period, above=0.0)
        finite_number("fraction", fraction, above=0.0, at_most=1.0)
        lower, upper = arm.lower_position_limit, arm.upper_position_limit
        if center is None:
            x = arm.to_joint_positions(arm.neutral)
            half = np.where(np.isfinite(upper - lower), 0.5 * (upper - lower), np.inf)
            room = np.minimum(amplitude, half)
            x = np.clip(x, lower + room, upper - room)
        else:
            x = arm.to_joint_positions(finite_vector("center", center, arm.nq))
        periods = period * (1.0 + 0.12 * np.arange(arm.nv))
        room = np.minimum(x - lower, upper - x)
        peak_speed = 2.0 * np.pi / periods + (1.875 / ramp if ramp > 0.0 else 0.0)
        amplitudes = np.minimum(np.full(arm.nv, amplitude), 0.9 * np.maximum(room, 0.0))
        amplitudes = np.minimum(amplitudes, fraction * arm.velocity_limit / peak_speed)
        return cls(
            arm=arm,
            center=arm.from_joint_positions(x),
            amplitude=amplitudes,
            period=periods,
            ramp=ramp,
        )


def _fade_in(t: float, ramp: float) -> tuple[float, float, float]:
    """Return the fade-in and its first two derivatives."""
    if t >= ramp:
        return 1.0, 0.0, 0.0
    u = max(t, 0.0) / ramp
    return (
        u**3 * (10.0 - 15.0 * u + 6.0 * u**2),
        30.0 * u**2 * (1.0 - u) ** 2 / ramp,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / ramp**2,
    )
