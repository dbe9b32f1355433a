"""Parameters as rows with names and units, and in words what could not be told."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.identification.base_parameters import BODY, units_of
from fotsmc_pin.identification.result import IdentifiedParameter

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.base_parameters import Base
    from fotsmc_pin.identification.prior import Belief
    from fotsmc_pin.identification.regressor import Parameters
    from fotsmc_pin.types import Array

GROUPS = ("mass", *["first moment"] * 3, *["inertia"] * 6)


def parameter_rows(
    arm: Arm, parameters: Parameters, belief: Belief, theta: Array, covariance: Array
) -> tuple[IdentifiedParameter, ...]:
    """Return a row for each parameter."""
    kinds = [
        (group, f"{joint} {symbol}")
        for joint in arm.joint_names
        for group, symbol in zip(GROUPS, BODY, strict=True)
    ]
    kinds += [(name, joint) for name in parameters.own for joint in arm.joint_names]
    units = units_of(arm, parameters)
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    doubt = np.sqrt(np.diag(belief.covariance))
    return tuple(
        IdentifiedParameter(
            group=group,
            of=of,
            value=float(theta[k]),
            deviation=float(deviation[k]),
            nominal=float(belief.mean[k]),
            doubt=float(doubt[k]),
            unit=units[k],
        )
        for k, (group, of) in enumerate(kinds)
    )


def base_rows(
    base: Base, belief: Belief, theta: Array, covariance: Array
) -> tuple[IdentifiedParameter, ...]:
    """Return a row for each base parameter."""
    matrix = base.matrix
    values, nominal = matrix @ theta, matrix @ belief.mean
    deviation = np.sqrt(np.maximum(np.einsum("bp,pq,bq->b", matrix, covariance, matrix), 0.0))
    doubt = np.sqrt(np.einsum("bp,pq,bq->b", matrix, belief.covariance, matrix))
    return tuple(
        IdentifiedParameter(
            group="base",
            of=base.names[k],
            value=float(values[k]),
            deviation=float(deviation[k]),
            nominal=float(nominal[k]),
            doubt=float(doubt[k]),
            unit=base.units[k],
        )
        for k in range(len(base.names))
    )


def untold(
    arm: Arm, base: Base, rows: tuple[IdentifiedParameter, ...], offset: bool
) -> tuple[str, ...]:
    """Return in words what could not be told, or not apart."""
    sentences = []
    for k, joint in enumerate(arm.joint_names):
        silent = [symbol for symbol in BODY if f"{symbol}{k + 1}" in base.without_effect]
        if len(silent) == len(BODY):
            sentences.append(f"{joint}: nothing of the body behind it changes any torque.")
        elif silent:
            sentences.append(
                f"{joint}: {', '.join(silent)} of the body behind it change no torque; they stand "
                "as in the file, or as the other numbers demand."
            )
    if base.together:
        sentences.append(
            f"{len(base.together)} of {len(base.names)} base parameters are sums, such as "
            f"{_shortest(base)}: their parts cannot be told apart by any motion, and were divided "
            "as the file has them."
        )
    vague = [row.of for row in rows if not row.known]
    if vague:
        shown = "; ".join(vague[:6]) + (f"; and {len(vague) - 6} more" if len(vague) > 6 else "")
        sentences.append(f"This motion told little of: {shown}. A livelier one would tell more.")
    if offset:
        sentences.append("A URDF has no tag for a constant offset of the torque: it is not in it.")
    return tuple(sentences)


def _shortest(base: Base) -> str:
    sums = [name for name in base.names if " " in name]
    return min(sums, key=len)
