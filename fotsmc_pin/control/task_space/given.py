"""What a tick of a task is given: checked, and copied to where the kernels find it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.arguments import LARGEST
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.rows import Joints, named_rows
from fotsmc_pin.control.task_space.tool_rows import POINT, PointRows, ToolRows
from fotsmc_pin.errors import ArgumentError, MeasurementError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

STRAIGHT = 1e-6
"""How far the columns of a rotation may be from orthonormal."""


def homogeneous(pose: Any) -> Array:
    """Return a pose, an `SE3` or a matrix (4, 4), as a matrix.

    Raises:
        MeasurementError: it is neither, not finite, or its rotation is none.
    """
    try:
        matrix = pose.homogeneous if isinstance(pose, pin.SE3) else np.array(pose, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.zeros(0)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        remedy = "give a pinocchio.SE3, or a finite matrix (4, 4)"
        raise MeasurementError("T", pose, remedy)
    R = matrix[:3, :3]
    if np.abs(R.T @ R - np.eye(3)).max() > STRAIGHT or np.linalg.det(R) < 0.0:
        raise MeasurementError("T", matrix.tolist(), "its rotation is none: normalize it")
    return matrix


def twist(name: str, value: Any) -> Array:
    """Return a twist or its derivative (6,), a `pinocchio.Motion` or numbers.

    Raises:
        MeasurementError: a wrong shape, or not finite.
    """
    numbers = value.vector if isinstance(value, pin.Motion) else value
    try:
        return checks.finite_vector(name, numbers, 6)
    except ArgumentError as error:
        raise MeasurementError(name, value, error.remedy) from None


def cleaned_motion(arm: Arm, q: Any, v: Any, T: Any, V: Any, A: Any) -> tuple[Array, ...]:
    """Return the arguments of a tick as plain arrays.

    Raises:
        MeasurementError: naming the first argument of the wrong shape or not finite.
    """
    found = []
    for name, value, size in (("q", q, arm.nq), ("v", v, arm.nv)):
        try:
            found.append(checks.finite_vector(name, value, size))
        except ArgumentError as error:
            raise MeasurementError(name, value, error.remedy) from None
    matrix = pin.SE3(homogeneous(T)).homogeneous
    return (*found, matrix, twist("V", V), twist("A", A))


@kernel
def read_motion(
    q: Array, v: Array, T: Array, V: Array, A: Array,
    configurations: Array, joints: Array, tool: Array, poses: Array,
) -> bool:  # fmt: skip
    """Copy the arguments of a tick, each number kept below `LARGEST`, and the point's speed.

    The speed is `v_d` of the joints, at which friction that is known is fed forward.
    Returns whether every array has its shape, every number is finite, and the rotation is one.
    """
    t, x = named_rows(tool, ToolRows), named_rows(joints, Joints)
    p = named_rows(joints[POINT:], PointRows)
    nq, nv = configurations.shape[1], joints.shape[1]
    if not (q.shape == (nq,) and v.shape == (nv,) and V.shape == A.shape == (6,)):
        return False
    total = 0.0
    for k in range(nq):
        total += q[k]
    for k in range(nv):
        total += v[k]
    for k in range(6):
        total += V[k] + A[k]
    for i in range(3):
        total += T[i, 3]
        for j in range(i + 1):
            product = -1.0 if i == j else 0.0
            for k in range(3):
                product += T[k, i] * T[k, j]
            if not abs(product) < STRAIGHT:
                return False
    determinant = (
        T[0, 0] * (T[1, 1] * T[2, 2] - T[1, 2] * T[2, 1])
        + T[0, 1] * (T[1, 2] * T[2, 0] - T[1, 0] * T[2, 2])
        + T[0, 2] * (T[1, 0] * T[2, 1] - T[1, 1] * T[2, 0])
    )
    if not (math.isfinite(total) and determinant > 0.0):
        return False
    for k in range(nq):
        configurations[0, k] = clip(q[k], LARGEST)
    for k in range(nv):
        x.v[k], x.v_d[k] = clip(v[k], LARGEST), p.v[k]
    for k in range(6):
        t.V_d[k], t.A_d[k] = clip(V[k], LARGEST), clip(A[k], LARGEST)
    for i in range(3):
        poses[0, 3, i] = clip(T[i, 3], LARGEST)
        for j in range(3):
            poses[0, i, j] = T[i, j]
    return True
