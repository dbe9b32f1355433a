"""What is believed of an arm before its log is read: its file's numbers, and how wrong they are.

A body's ten parameters are not doubted one by one: a link that is heavier than its file says has
larger moments too. So the doubt is a sum of independent changes, to first order: density, a shift
of the centre of mass, rotational inertia about it, and at the last body what the tool holds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.drive_size import drive_size

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.regressor import Parameters
    from fotsmc_pin.types import Array

DENSITY = 0.4
"""Standard deviation of a body's mass and inertia over the nominal ones."""
CENTRE = 0.15
"""Of its centre of mass, over the size of the body."""
ROTATIONAL = 0.5
"""Of its rotational inertia about that centre, over a plausible one."""
GYRATION = 0.3
"""Radius of gyration of a plausible body over its size."""
HELD, HELD_AT = 0.15, 0.1
"""Of the payload over the mass of the moving links, and of its centre from the tool frame [m]."""
LIMIT_OVER_ARMATURE = 150.0
"""Effort limit over the standard deviation of an armature [rad/s², m/s²]."""
FRICTION, FULL_EFFORT = 0.5, 20.0
"""Standard deviation of Coulomb [N·m] and viscous [N·m·s/rad] friction of a joint with at least
this effort limit; of a weaker one in proportion less."""
OFFSET = 0.05
"""Of a constant offset of the torque, over the effort limit."""
SMALLEST = 0.05
"""Size of a body that seems to have none [m]."""
LEAST_MOMENT = 1e-3
"""Least second moment of the nominal mass along any axis, over a plausible one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Belief:
    """A Gaussian belief of the parameters: its mean (p,), and covariance (p, p)."""

    mean: Array
    covariance: Array


def nominal_belief(
    arm: Arm, parameters: Parameters, *, links: float = DENSITY, held: float | None = None
) -> Belief:
    """Return what an arm's file says of it, and how much of that to believe.

    Args:
        arm: the nominal arm.
        parameters: the order of the unknowns.
        links: standard deviation of a link's mass over the nominal one; the doubt of centres and
            inertias grows and shrinks with it.
        held: standard deviation of the payload's mass at the tool [kg]; None for a share of the
            mass of the moving links.
    """
    n, p = arm.nv, parameters.size
    mean, covariance = np.zeros(p), np.zeros((p, p))
    bodies = [*arm.model.inertias][1:]
    sizes = body_sizes(arm)
    doubt = links / DENSITY
    for k, (inertia, size) in enumerate(zip(bodies, sizes, strict=True)):
        sound = made_sound(inertia, size)
        place = parameters.body(k)
        mean[place] = sound.toDynamicParameters()
        modes = doubt * body_modes(sound, size)
        covariance[place, place] = modes @ modes.T
    mass = HELD * sum(body.mass for body in bodies) if held is None else held
    tool = parameters.body(int(arm.model.frames[arm.tool_frame_id].parentJoint) - 1)
    modes = held_modes(arm, mass)
    covariance[tool, tool] += modes @ modes.T
    drive = drive_size(arm)
    rubbing = FRICTION * np.minimum(1.0, drive / FULL_EFFORT)
    own = {
        "armature": (arm.armature, np.maximum(drive / LIMIT_OVER_ARMATURE, 0.5 * arm.armature)),
        "damping": (arm.damping, np.maximum(rubbing, arm.damping)),
        "friction": (arm.friction, np.maximum(rubbing, arm.friction)),
        "offset": (np.zeros(n), OFFSET * drive),
        "stribeck": (arm.friction * (arm.stiction - 1.0), np.maximum(rubbing, arm.friction)),
    }
    for name in parameters.own:
        place = parameters.groups[name]
        mean[place], deviation = own[name]
        covariance[place, place] = np.diag(deviation**2)
    return Belief(mean=mean, covariance=covariance)


def body_sizes(arm: Arm) -> Array:
    """Return a length for each body (nv,): how far its centre or the next joint is away [m]."""
    model = arm.model
    sizes = np.array([np.linalg.norm(body.lever) for body in [*model.inertias][1:]])
    for joint in range(1, model.njoints):
        parent = model.parents[joint]
        if parent > 0:
            away = float(np.linalg.norm(model.jointPlacements[joint].translation))
            sizes[parent - 1] = max(sizes[parent - 1], away)
    tool = model.frames[arm.tool_frame_id]
    away = float(np.linalg.norm(tool.placement.translation))
    sizes[tool.parentJoint - 1] = max(sizes[tool.parentJoint - 1], away)
    return np.asarray(np.maximum(sizes, SMALLEST), dtype=np.float64)


def made_sound(inertia: pin.Inertia, size: float) -> pin.Inertia:
    """Return an inertia that matter can have, of the same mass and centre.

    Makers' files hold zeros and rounded numbers: second moments of mass below a thousandth of a
    plausible one are raised to that.
    """
    moments, axes = second_moments(inertia)
    least = LEAST_MOMENT * inertia.mass * (GYRATION * size) ** 2
    covariance = (axes * np.maximum(moments, least)) @ axes.T
    about = np.trace(covariance) * np.eye(3) - covariance
    return pin.Inertia(inertia.mass, inertia.lever, 0.5 * (about + about.T))


def second_moments(inertia: pin.Inertia) -> tuple[Array, Array]:
    """Return the principal second moments of mass about the centre (3,) and their axes (3, 3)."""
    about = np.array(inertia.inertia)
    moments, axes = np.linalg.eigh(0.5 * np.trace(about) * np.eye(3) - about)
    return moments, axes


def body_modes(inertia: pin.Inertia, size: float) -> Array:
    """Return the independent changes that a body is believed to have, as columns (10, 10)."""
    density = DENSITY * np.array(inertia.toDynamicParameters())
    step = CENTRE * size
    shifts = [0.5 * step * (_moved(inertia, axis) - _moved(inertia, -axis)) for axis in np.eye(3)]
    trace = float(np.trace(inertia.inertia))
    plausible = max(trace, 2.0 * inertia.mass * (GYRATION * size) ** 2)
    return np.column_stack([density, *shifts, *_rotational(ROTATIONAL / 3.0 * plausible)])


def held_modes(arm: Arm, mass: float) -> Array:
    """Return the changes that a payload at the tool makes to its body, as columns (10, 10)."""
    place = np.array(arm.model.frames[arm.tool_frame_id].placement.translation)
    moments = [0.5 * mass * HELD_AT * (_point(place + e) - _point(place - e)) for e in np.eye(3)]
    return np.column_stack([mass * _point(place), *moments, *_rotational(mass * HELD_AT**2)])


def _moved(inertia: pin.Inertia, shift: Array) -> Array:
    moved = pin.Inertia(inertia.mass, inertia.lever + shift, inertia.inertia)
    return np.array(moved.toDynamicParameters())


def _rotational(size: float) -> Array:
    """Return six changes of the rotational inertia alone, rows of (6, 10)."""
    rows = np.zeros((6, 10))
    # Diagonal entries, then products of inertia at half the size.
    rows[[0, 1, 2], [4, 6, 9]] = size
    rows[[3, 4, 5], [5, 7, 8]] = 0.5 * size
    return rows


def _point(place: Array) -> Array:
    """Return the parameters of 1 kg in one point."""
    return np.array(pin.Inertia(1.0, place, np.zeros((3, 3))).toDynamicParameters())
