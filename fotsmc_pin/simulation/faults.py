"""Who is to blame when a run cannot go on: a part that returned nonsense, or a joint that ran away.

A tick checks nothing that it does not need. When one fails, the parts' last values are looked at.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fotsmc_pin.errors import ArgumentError, DivergenceError, MeasurementError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation.recording import Recording
    from fotsmc_pin.types import Array


NAMES = ("reference q_d", "reference v_d", "reference a_d")
NOTHING: Any = object()
"""Stands for what a part has not given yet."""
UNREASONABLE = 10.0
"""A joint that is this many times faster than its velocity limit has left."""
UNREASONABLE_SPEED = 100.0
"""The same for a joint without a velocity limit [rad/s, m/s]."""


class Tick(NamedTuple):
    """What the parts of a loop gave last: the values that a failure is judged by."""

    t: float
    target: tuple[Any, Any, Any]
    measured: Any
    commanded: Any
    driven: Any
    felt: Any


def fault_of(
    tick: Tick,
    arm: Arm,
    disturbance: Callable[[float], Any] | None,
    times: Sequence[float],
    *,
    poses: bool = False,
) -> ArgumentError | None:
    """Return an error that names the part whose value is not finite or has the wrong shape.

    Args:
        tick: what the parts gave.
        arm: the arm.
        disturbance: `t -> (nv,)`, or None.
        times: when the disturbance acted in the tick [s].
        poses: whether the reference is one of poses, which has been checked before.

    Returns:
        The error, or None where every part's value is sound.
    """
    q, v = (arm.nq,), (arm.nv,)
    target = () if poses else zip(NAMES, tick.target, (q, v, v), strict=True)
    for name, value, shape in target:
        if (what := flaw(value, shape)) is not None:
            return MeasurementError(name, value, f"at t = {tick.t:.6g} s it {what}")
    if tick.measured is not NOTHING:
        if not isinstance(tick.measured, (tuple, list)) or len(tick.measured) != 2:
            remedy = f"at t = {tick.t:.6g} s it is no pair: return (q, v)"
            return MeasurementError("sensor", tick.measured, remedy)
        for name, value, shape in zip(("q", "v"), tick.measured, (q, v), strict=True):
            if (what := flaw(value, shape)) is not None:
                return MeasurementError(f"sensor {name}", value, f"at t = {tick.t:.6g} s it {what}")
    torques = {"controller": tick.commanded, "actuator": tick.driven, "sensor": tick.felt}
    for name, value in torques.items():
        if value is not NOTHING and (what := flaw(value, v)) is not None:
            return ArgumentError(f"{name} torque", value, f"at t = {tick.t:.6g} s it {what}")
    for t in times if disturbance is not None else ():
        value = disturbance(t)  # type: ignore[misc]
        if (what := flaw(value, v)) is not None:
            return ArgumentError("disturbance", value, f"at t = {t:.6g} s it {what}")
    return None


def flaw(value: Any, shape: tuple[int, ...]) -> str | None:
    """Return what is wrong with an array that should be finite and of a shape, None if nothing."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return f"is no array of numbers; return shape {shape}"
    if array.shape != shape:
        return f"has shape {array.shape}; return shape {shape}"
    return None if np.isfinite(array).all() else "is not finite; return finite numbers"


def divergence(
    arm: Arm, recording: Recording, time: float, lost: int, speed: Array
) -> DivergenceError:
    """Return the error that says when a run was given up, and which joint left first, and when.

    Args:
        arm: the arm.
        recording: everything up to the failure.
        time: when the plant gave up [s].
        lost: the joint by which it did.
        speed: of the joints at that time (nv,), perhaps not finite.
    """
    limit = arm.velocity_limit
    bound = np.where(np.isfinite(limit), UNREASONABLE * limit, UNREASONABLE_SPEED)
    excess = np.abs(recording.v) / bound
    beyond = np.flatnonzero((excess > 1.0).any(axis=1))
    left, first, reached, others = time, lost, float(speed[lost]), ""
    if beyond.size:
        row = int(beyond[0])
        left, first = float(recording.t[row]), int(excess[row].argmax())
        reached = float(recording.v[row, first])
        also = [arm.joint_names[j] for j in np.flatnonzero(excess[row] > 1.0) if j != first]
        others = f", in the same tick as {', '.join(also)}" if also else ""
    joint, unit = arm.joint_names[first], arm.position_units[first]
    return DivergenceError(
        f"the simulation diverged at t = {time:.4g} s: joint {joint!r} left "
        f"first, at t = {left:.4g} s, with {reached:.3g} {unit}/s{others}; try more substeps, "
        "a shorter tick, or lower gains",
        time,
        joint,
        recording,
    )
