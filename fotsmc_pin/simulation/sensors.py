"""What sensors make of the true state: noise, quantisation, velocity from position; torque.

A sensor is any callable `(t, q, v) -> (q, v)`; a `reset()` is called at the start of a run if it
has one. One that also has `measure_torque`, a callable `(t, tau) -> tau`, reads the torque at the
joints for the recording. `Chain` puts several one after the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, overload

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.differentiator import FilteredDifferentiator

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class NoisySensor:
    """White Gaussian noise on position and velocity, the same in every run of one seed.

    Args:
        arm: the arm that is measured.
        position: standard deviation of the position noise, one number or one per joint [rad, m].
        velocity: standard deviation of the velocity noise [rad/s, m/s].
        seed: of the noise.

    Raises:
        ArgumentError: a negative standard deviation or seed.
    """

    def __init__(
        self, arm: Arm, *, position: ArrayLike = 0.0, velocity: ArrayLike = 0.0, seed: int = 0
    ) -> None:
        self.arm = arm
        self.position = checks.per_joint("position", position, arm.nv, at_least=0.0)
        self.velocity = checks.per_joint("velocity", velocity, arm.nv, at_least=0.0)
        self.seed = checks.count("seed", seed, at_least=0)
        self.reset()

    def reset(self) -> None:
        """Start the noise anew from the seed."""
        self._rng = np.random.default_rng(self.seed)

    def __call__(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Return `q` and `v` with noise, as fresh arrays."""
        n = self.arm.nv
        noise = self._rng.standard_normal(2 * n)
        return self.arm.integrate(q, self.position * noise[:n]), v + self.velocity * noise[n:]


class QuantizedSensor:
    """Encoders and tachometers with finite steps; each reading is the nearest step.

    Args:
        arm: the arm that is measured.
        position: step of the position, one number or one per joint [rad, m]; 0 for none. An encoder
            of 17 bits has `2π / 2**17`.
        velocity: step of the velocity [rad/s, m/s]; 0 for none.

    Raises:
        ArgumentError: a negative step.
    """

    def __init__(self, arm: Arm, *, position: ArrayLike = 0.0, velocity: ArrayLike = 0.0) -> None:
        self.arm = arm
        self.position = checks.per_joint("position", position, arm.nv, at_least=0.0)
        self.velocity = checks.per_joint("velocity", velocity, arm.nv, at_least=0.0)

    def __call__(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Return `q` and `v` rounded to their steps, as fresh arrays."""
        angles = self.arm.to_joint_positions(q)
        step = _rounded(angles, self.position) - angles
        return self.arm.integrate(q, step), _rounded(v, self.velocity)


class Encoder:
    """An encoder of some bits in a turn and no velocity sensor, as most arms have it.

    The position stands on the nearest of `2**bits` steps of a turn; the velocity is what a
    differentiator of this library makes of these readings.

    Args:
        arm: the arm that is measured.
        dt: nominal period of a tick [s].
        bits: of a turn.
        turn: travel of the joint in one turn of its encoder, one number or one per joint [rad, m].
            By default 2π, and 0.02 m for a slide, the lead of a common screw; for an encoder before
            a gear of ratio N it is 2π/N.
        differentiator: what makes the velocity; None for a
            `control.FilteredDifferentiator` of 300 rad/s.

    Raises:
        ArgumentError: no whole number of bits above 0, or a travel that is not above 0.
    """

    def __init__(
        self,
        arm: Arm,
        dt: float,
        *,
        bits: int = 17,
        turn: ArrayLike | None = None,
        differentiator: Differentiator | None = None,
    ) -> None:
        self.arm, self.bits = arm, checks.count("bits", bits)
        if turn is None:
            slides = np.array([unit == "m" for unit in arm.position_units])
            turn = np.where(slides, 0.02, 2.0 * np.pi)
        self.turn = checks.per_joint("turn", turn, arm.nv, above=0.0)
        steps = QuantizedSensor(arm, position=self.turn / 2.0**self.bits)
        self.differentiator = differentiator or FilteredDifferentiator(arm, dt)
        self._parts = Chain(steps, VelocityFromPosition(self.differentiator))

    @property
    def step(self) -> Array:
        """Distance of two readings (nv,) [rad, m]."""
        return self.turn / 2.0**self.bits

    def reset(self) -> None:
        """Forget every position."""
        self._parts.reset()

    def __call__(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Return the position on its step and the velocity that follows from such positions."""
        measured: tuple[Array, Array] = self._parts(t, q, v)
        return measured


class Differentiator(Protocol):
    """Anything that computes velocity from positions, such as `FilteredDifferentiator`."""

    def update(self, q: ArrayLike, dt: float | None = None) -> Array:
        """Return the velocity (nv,) after one more position."""
        ...

    def reset(self) -> None:
        """Forget every position."""
        ...


class VelocityFromPosition:
    """No tachometer: a differentiator computes the velocity from the measured position.

    Args:
        differentiator: `control.FilteredDifferentiator`, `control.ExactDifferentiator` or your own.
    """

    def __init__(self, differentiator: Differentiator) -> None:
        self.differentiator = differentiator

    def reset(self) -> None:
        """Forget every position."""
        self.differentiator.reset()

    def __call__(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Return `q` as it came and the velocity that follows from it."""
        return q, self.differentiator.update(q)


class TorqueSensor:
    """Torque sensors in the joints, or currents that stand for it: white noise and finite steps.

    The reading is `step · round((τ + noise · N(0, 1)) / step)` of the torque that the drives apply,
    friction not yet taken off; on an elastic joint it is that of the motor. Position and velocity
    pass unchanged, so put it into a `Chain` with what measures these.

    Args:
        arm: the arm that is measured.
        noise: standard deviation, one number or one per joint [N·m, N].
        step: of the reading, one number or one per joint [N·m, N]; 0 for none.
        seed: of the noise, which is the same in every run of one seed.

    Raises:
        ArgumentError: a negative standard deviation, step or seed.
    """

    def __init__(
        self, arm: Arm, *, noise: ArrayLike = 0.0, step: ArrayLike = 0.0, seed: int = 0
    ) -> None:
        self.noise = checks.per_joint("noise", noise, arm.nv, at_least=0.0)
        self.step = checks.per_joint("step", step, arm.nv, at_least=0.0)
        self.seed = checks.count("seed", seed, at_least=0)
        self.reset()

    def reset(self) -> None:
        """Start the noise anew from the seed."""
        self._rng = np.random.default_rng(self.seed)

    def __call__(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """Return `q` and `v` as they came."""
        return q, v

    def measure_torque(self, t: float, tau: Array) -> Array:
        """Return the reading of `tau` (nv,) [N·m, N], a fresh array."""
        noise = self.noise * self._rng.standard_normal(self.noise.size)
        return _rounded(tau + noise, self.step)


def torque_reader(sensor: object) -> Callable[[float, Array], Array] | None:
    """Return what reads the torque in a sensor or in the parts of a chain, None if nothing does."""
    if not isinstance(sensor, Chain):
        return getattr(sensor, "measure_torque", None)
    readers = [reader for reader in map(torque_reader, sensor.parts) if reader is not None]
    return Chain(*readers) if readers else None


class Chain:
    """Several sensors, or several actuators, each given the output of the one before.

    Args:
        *parts: sensors `(t, q, v) -> (q, v)` or actuators `(t, tau) -> tau`, not mixed.
    """

    def __init__(self, *parts: Callable[..., object]) -> None:
        self.parts = parts

    def reset(self) -> None:
        """Reset every part that has a `reset`."""
        for part in self.parts:
            reset = getattr(part, "reset", None)
            if reset is not None:
                reset()

    @overload
    def __call__(self, t: float, tau: Array, /) -> Array: ...
    @overload
    def __call__(self, t: float, q: Array, v: Array, /) -> tuple[Array, Array]: ...
    def __call__(self, t: float, *values: Array) -> Any:
        """Return the last part's output."""
        result: Any = values if len(values) > 1 else values[0]
        for part in self.parts:
            result = part(t, *(result if isinstance(result, tuple) else (result,)))
        return result


def _rounded(x: Array, step: Array) -> Array:
    safe = np.where(step > 0.0, step, 1.0)
    return np.where(step > 0.0, safe * np.round(x / safe), x)
