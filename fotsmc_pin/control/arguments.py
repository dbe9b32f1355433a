"""The arguments of a tick: checked, bounded, and copied to where a law finds them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.gains import Gains
from fotsmc_pin.control.rows import NoRows, rows
from fotsmc_pin.errors import ArgumentError, MeasurementError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

LARGEST = 1e8
"""Positions, speeds and accelerations beyond this are taken as this, so that nothing overflows."""

ROUNDNESS = 1e-3
"""How far the cosine and sine of a continuous joint may lie from the unit circle."""

ARGUMENTS = ("q", "v", "q_d", "v_d", "a_d")


@kernel
def read_arguments(
    q: Array, v: Array, q_d: Array, v_d: Array, a_d: Array, configurations: Array, table: Array
) -> bool:
    """Copy the arguments of a tick, each number kept below `LARGEST`; fill in `e` and `ė`.

    `e` is that of plain joints, whose difference is that of their numbers. Returns whether every
    array has its shape and every number is finite.
    """
    x, _, _, _ = rows(table, Gains, NoRows, NoRows)
    nq, nv = configurations.shape[1], table.shape[1]
    if not (q.shape == q_d.shape == (nq,) and v.shape == v_d.shape == a_d.shape == (nv,)):
        return False
    for k in range(nq):
        if not (math.isfinite(q[k]) and math.isfinite(q_d[k])):
            return False
        configurations[0, k], configurations[1, k] = clip(q[k], LARGEST), clip(q_d[k], LARGEST)
    for j in range(nv):
        if not (math.isfinite(v[j]) and math.isfinite(v_d[j]) and math.isfinite(a_d[j])):
            return False
        x.e[j] = configurations[0, j] - configurations[1, j]
        x.v[j] = clip(v[j], LARGEST)
        x.v_d[j] = clip(v_d[j], LARGEST)
        x.a_d[j] = clip(a_d[j], LARGEST)
        x.e_dot[j] = x.v[j] - x.v_d[j]
    return True


def cleaned_arguments(nq: int, nv: int, *values: ArrayLike) -> list[Array]:
    """Return the arguments as plain arrays: of lists, whole numbers and strided arrays too.

    Raises:
        MeasurementError: naming the first argument of the wrong shape or not finite.
    """
    clean = []
    for name, value, size in zip(ARGUMENTS, values, (nq, nv, nq, nv, nv), strict=True):
        try:
            clean.append(checks.finite_vector(name, value, size))
        except ArgumentError as error:
            raise MeasurementError(name, value, error.remedy) from None
    return clean


def demand_round(arm: Arm, name: str, value: Any, q: Array) -> None:
    """Refuse a configuration whose cosines and sines are none; plain joints pass.

    Args:
        arm: the arm.
        name: what the argument is called.
        value: the argument as it was given.
        q: the same as numbers (nq,).

    Raises:
        MeasurementError: a continuous joint's pair lies farther than `ROUNDNESS` from the circle.
    """
    if not (arm.is_euclidean or pin.isNormalized(arm.model, q, ROUNDNESS)):
        remedy = "give the cosine and sine of each continuous joint"
        raise MeasurementError(name, value, remedy)
