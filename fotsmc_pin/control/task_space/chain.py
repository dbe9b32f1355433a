"""Where the tool is and how it moves: the kinematics of the chain of joints that carries it.

Pinocchio would do the same, in several calls for the arm and again for the feasible reference; a
kernel of our own stays in the machine code of the tick.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.compiled import kernel
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

TURNS, TURNS_WITHOUT_END, SLIDES = 0, 1, 2
"""Kinds of joints; one without end has the cosine and sine of its angle in `q`."""


def chain_of(arm: Arm, frame: int) -> tuple[NDArray[np.int64], Array]:
    """Return the joints that carry a frame, and what is rigid between them.

    The frames of the joints are turned so that each moves along or about its own z axis.

    Args:
        arm: the arm.
        frame: index of the frame.

    Returns:
        For each joint its place in `v`, its place in `q` and its kind (k, 3); and rotation and
        origin of each joint's frame in the one before, last of the frame itself (k + 1, 4, 3).

    Raises:
        ArgumentError: one of the joints has several axes.
    """
    model = arm.model
    rest, before = pin.neutral(model), np.eye(3)
    joints, places = [], []
    for number in model.supports[model.frames[frame].parentJoint][1:]:
        joint, placement = model.joints[number], model.jointPlacements[number]
        if joint.nv != 1:
            remedy = f"{model.names[number]} has {joint.nv} axes: lock it"
            raise ArgumentError("arm", arm.name, remedy)
        data = joint.createData()
        joint.calc(data, rest[joint.idx_q : joint.idx_q + joint.nq])
        along, about = np.split(np.array(data.S).ravel(), 2)
        kind = SLIDES if along.any() else joint.nq - 1
        joints.append((joint.idx_v, joint.idx_q, kind))
        own = _with_z_along(along if kind == SLIDES else about)
        places.append(_place(before, placement, own))
        before = own
    places.append(_place(before, model.frames[frame].placement, np.eye(3)))
    return np.array(joints, dtype=np.int64), np.array(places)


def _place(before: Array, placement: pin.SE3, own: Array) -> Array:
    return np.vstack([before.T @ placement.rotation @ own, before.T @ placement.translation])


def _with_z_along(axis: Array) -> Array:
    """Return a rotation whose third column is `axis`; the identity for z itself."""
    x = np.cross(np.eye(3)[(int(np.argmax(np.abs(axis))) + 2) % 3], axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


@kernel
def chain_motion(
    chain: NDArray[np.int64], places: Array, q: Array, v: Array,
    pose: Array, J: Array, twist: Array, bias: Array,
) -> None:  # fmt: skip
    """Write the tool's pose, its Jacobian `J`, its twist `J v` and `J̇ v`, in its own axes.

    From joint to joint go the axes `R`, the origin `p`, its velocity `u` and acceleration `b` at
    zero joint acceleration, the angular velocity `ω` and acceleration `l`, all in the world. At the
    tool, with `V` in its own axes, `V̇ = (Rᵀ (b - ω × u), Rᵀ l)`.

    Args:
        chain: the joints, as `chain_of` has them (k, 3).
        places: what is rigid between them (k + 1, 4, 3).
        q: configuration (nq,).
        v: speed of the joints (nv,).
        pose: rows of rotation, and the origin (4, 3), overwritten.
        J: (6, nv), overwritten; zero for joints that do not carry the tool.
        twist: (6,), overwritten.
        bias: (6,), overwritten.
    """
    R, p, count = pose[:3], pose[3], chain.shape[0]
    for i in range(3):
        p[i] = 0.0
        for j in range(3):
            R[i, j] = 1.0 if i == j else 0.0
    for i in range(6):
        for j in range(v.size):
            J[i, j] = 0.0
    w0 = w1 = w2 = l0 = l1 = l2 = u0 = u1 = u2 = b0 = b1 = b2 = 0.0
    for k in range(count + 1):
        C = places[k]
        c, s, travel, j, kind = 1.0, 0.0, 0.0, 0, TURNS
        if k < count:
            j, at, kind = chain[k, 0], chain[k, 1], chain[k, 2]
            if kind == TURNS:
                c, s = math.cos(q[at]), math.sin(q[at])
            elif kind == SLIDES:
                travel = q[at]
            else:
                c, s = q[at], q[at + 1]
        # d: from the last origin to this one, at rest in the last frame
        x0, x1, x2 = C[3, 0] + C[0, 2] * travel, C[3, 1] + C[1, 2] * travel, C[3, 2]
        x2 += C[2, 2] * travel
        d0 = R[0, 0] * x0 + R[0, 1] * x1 + R[0, 2] * x2
        d1 = R[1, 0] * x0 + R[1, 1] * x1 + R[1, 2] * x2
        d2 = R[2, 0] * x0 + R[2, 1] * x1 + R[2, 2] * x2
        x0, x1, x2 = w1 * d2 - w2 * d1, w2 * d0 - w0 * d2, w0 * d1 - w1 * d0
        p[0], p[1], p[2] = p[0] + d0, p[1] + d1, p[2] + d2
        u0, u1, u2 = u0 + x0, u1 + x1, u2 + x2
        b0 += l1 * d2 - l2 * d1 + w1 * x2 - w2 * x1
        b1 += l2 * d0 - l0 * d2 + w2 * x0 - w0 * x2
        b2 += l0 * d1 - l1 * d0 + w0 * x1 - w1 * x0
        for i in range(3):
            x0 = R[i, 0] * C[0, 0] + R[i, 1] * C[1, 0] + R[i, 2] * C[2, 0]
            x1 = R[i, 0] * C[0, 1] + R[i, 1] * C[1, 1] + R[i, 2] * C[2, 1]
            R[i, 2] = R[i, 0] * C[0, 2] + R[i, 1] * C[1, 2] + R[i, 2] * C[2, 2]
            R[i, 0], R[i, 1] = c * x0 + s * x1, c * x1 - s * x0
        if k == count:
            break
        # The joint's own motion along or about a = R z
        a0, a1, a2, rate = R[0, 2], R[1, 2], R[2, 2], v[j]
        x0, x1, x2 = w1 * a2 - w2 * a1, w2 * a0 - w0 * a2, w0 * a1 - w1 * a0
        if kind == SLIDES:
            u0, u1, u2 = u0 + rate * a0, u1 + rate * a1, u2 + rate * a2
            b0, b1, b2 = b0 + 2.0 * rate * x0, b1 + 2.0 * rate * x1, b2 + 2.0 * rate * x2
            J[0, j], J[1, j], J[2, j] = a0, a1, a2
        else:
            w0, w1, w2 = w0 + rate * a0, w1 + rate * a1, w2 + rate * a2
            l0, l1, l2 = l0 + rate * x0, l1 + rate * x1, l2 + rate * x2
            J[0, j], J[1, j], J[2, j] = p[0], p[1], p[2]
            J[3, j], J[4, j], J[5, j] = a0, a1, a2
    b0, b1, b2 = b0 - w1 * u2 + w2 * u1, b1 - w2 * u0 + w0 * u2, b2 - w0 * u1 + w1 * u0
    for i in range(3):
        x0, x1, x2 = R[0, i], R[1, i], R[2, i]
        twist[i], twist[3 + i] = x0 * u0 + x1 * u1 + x2 * u2, x0 * w0 + x1 * w1 + x2 * w2
        bias[i], bias[3 + i] = x0 * b0 + x1 * b1 + x2 * b2, x0 * l0 + x1 * l1 + x2 * l2
    # Columns: a × (p - p_j) and a of what turns, a alone of what slides, in the tool's axes
    for k in range(count):
        j = chain[k, 0]
        a0, a1, a2 = J[3, j], J[4, j], J[5, j]
        x0, x1, x2 = J[0, j], J[1, j], J[2, j]
        if chain[k, 2] != SLIDES:
            d0, d1, d2 = p[0] - x0, p[1] - x1, p[2] - x2
            x0, x1, x2 = a1 * d2 - a2 * d1, a2 * d0 - a0 * d2, a0 * d1 - a1 * d0
        for i in range(3):
            J[i, j] = R[0, i] * x0 + R[1, i] * x1 + R[2, i] * x2
            J[3 + i, j] = R[0, i] * a0 + R[1, i] * a1 + R[2, i] * a2
