"""`broken_limits`: which of an arm's limits a reference would exceed, and when."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.checks import count, finite_number
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Reference


class ReferenceWarning(UserWarning):
    """A reference asks for more speed or effort than an arm has."""


def warn_of_limits(arm: Arm, reference: Reference, duration: float) -> None:
    """Warn where a reference asks for more than an arm has, whatever law follows it.

    Args:
        arm: the arm that moves.
        reference: `t -> (q_d, v_d, a_d)`.
        duration: how far to look [s].

    Warns:
        ReferenceWarning: which joint, how much, when, and the limit.
    """
    broken = broken_limits(arm, reference, duration=duration)
    if broken:
        more = f" (and {len(broken) - 3} more)" if len(broken) > 3 else ""
        warn_user(
            f"the reference asks for more than {arm.name} has: {'; '.join(broken[:3])}{more}; "
            "make it slower or smaller",
            ReferenceWarning,
        )


def broken_limits(
    arm: Arm,
    reference: Reference,
    *,
    duration: float | None = None,
    samples: int = 1000,
    effort_share: float = 1.0,
) -> tuple[str, ...]:
    """Return one sentence for each limit that a reference exceeds.

    Positions, velocities and the model's own effort `M a_d + C v_d + G` are sampled in time.

    Args:
        arm: the arm whose limits count.
        reference: `t -> (q_d, v_d, a_d)`.
        duration: time span to check [s]; by default the reference's own.
        samples: at how many times.
        effort_share: share of the effort limits that the reference may use.

    Raises:
        ArgumentError: a duration is needed and none is given.
    """
    demand_arm(arm)
    if duration is None:
        duration = getattr(reference, "duration", None)
    if duration is None or not np.isfinite(duration):
        raise ArgumentError("duration", duration, "the reference has no end: say how far to look")
    times = np.linspace(
        0.0, finite_number("duration", duration, at_least=0.0), count("samples", samples)
    )
    x = np.empty((len(times), arm.nv))
    v, tau = np.empty_like(x), np.empty_like(x)
    for row, t in enumerate(times):
        q_d, v_d, a_d = reference(float(t))
        x[row], v[row] = arm.to_joint_positions(q_d), v_d
        tau[row] = arm.inverse_dynamics(q_d, v_d, a_d)
    efforts = effort_share * arm.effort_limit
    sentences: list[str] = []
    for what, values, lowest, highest, units in (
        (
            "position",
            x,
            arm.lower_position_limit,
            arm.upper_position_limit,
            arm.position_units,
        ),
        (
            "velocity",
            v,
            -arm.velocity_limit,
            arm.velocity_limit,
            tuple(f"{unit}/s" for unit in arm.position_units),
        ),
        ("effort", tau, -efforts, efforts, arm.effort_units),
    ):
        beyond = np.maximum(values - highest, lowest - values)
        for joint, name in enumerate(arm.joint_names):
            row = int(np.argmax(beyond[:, joint]))
            if beyond[row, joint] > 1e-9:
                value = values[row, joint]
                limit = highest[joint] if value > highest[joint] else lowest[joint]
                sentences.append(
                    f"{name}: {what} {value:.4g} {units[joint]} at {times[row]:.3g} s, "
                    f"limit {limit:.4g} {units[joint]}"
                )
    return tuple(sentences)
