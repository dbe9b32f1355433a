"""References of poses: checked, and evaluated for many ticks at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.task_space.given import homogeneous, twist
from fotsmc_pin.errors import ArgumentError, MeasurementError

if TYPE_CHECKING:
    import pinocchio as pin
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, PoseReference


def follows_poses(controller: object) -> bool:
    """Return whether a controller takes `(T, V, A)` in place of `(q_d, v_d, a_d)`."""
    return bool(getattr(controller, "follows_poses", False))


def first_pose(arm: Arm, reference: Any) -> tuple[Array | None, Array]:
    """Check a reference of poses at time 0.

    Returns:
        The configuration (nq,) from which it starts, where it knows one; and rest (nv,).

    Raises:
        ArgumentError: it is none, or what it returns is not usable.
    """
    try:
        pose, V, A = reference(0.0)
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            "reference", reference, f"give a callable t -> (T, V, A); at t = 0: {error}"
        ) from error
    homogeneous(pose)
    twist("reference V", V)
    twist("reference A", A)
    start = getattr(reference, "q_start", None)
    if start is not None:
        start = checks.finite_vector("reference q_start", start, arm.nq)
    return start, np.zeros(arm.nv)


def start_of(arm: Arm, q0: ArrayLike | None, of_reference: Array | None) -> Array:
    """Return the configuration (nq,) in which a run starts.

    Raises:
        ArgumentError: none was given, and the reference knows none; or one that is not usable.
    """
    if q0 is None and of_reference is None:
        raise ArgumentError("q0", q0, "a reference of poses does not tell: give where the arm is")
    start: Any = of_reference if q0 is None else q0
    return checks.finite_vector("q0", start, arm.nq)


def pose_values(
    reference: PoseReference, t: Array
) -> tuple[list[pin.SE3], list[Array], list[Array]]:
    """Return the poses, their twists and the derivatives of those at the times `t` (N,).

    The controller looks at them more closely.

    Raises:
        MeasurementError: the reference returned what is no triple; it names the time.
    """
    found: tuple[list[Any], list[Array], list[Array]] = ([], [], [])
    for instant in t.tolist():
        row = reference(instant)
        if not isinstance(row, tuple) or len(row) != 3:
            remedy = f"at t = {instant:.6g} s it is not (T, V, A)"
            raise MeasurementError("reference", row, remedy)
        for rows, value in zip(found, row, strict=True):
            rows.append(value)
    return found
