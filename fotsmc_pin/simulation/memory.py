"""Runs that cannot fit into the memory of a machine are refused before they start."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

NUMBER = 8
"""Size of a number [bytes]."""
COLUMNS_PER_JOINT = 12
"""Numbers kept for each joint at a recorded tick, at the least: states, reference, errors, torque,
signals, and the copies made at the end.
"""


def demand_memory(arm: Arm, duration: float, dt: float, stride: int) -> None:
    """Refuse a run whose clock and recording need more than the machine's memory.

    Args:
        arm: the arm that moves.
        duration: simulated time [s].
        dt: period of a tick [s].
        stride: ticks from one recorded row to the next.

    Raises:
        ArgumentError: naming what is needed, what is there, and what to change.
    """
    ticks = duration / dt
    needed = NUMBER * ticks * (1.0 + COLUMNS_PER_JOINT * arm.nv / stride)
    there = _memory()
    if needed > there:
        raise ArgumentError(
            "duration",
            duration,
            f"{ticks:.3g} ticks need {needed / 1e9:.3g} GB and this machine has {there / 1e9:.3g}; "
            "run shorter, or record less often with record_every",
        )


def _memory() -> float:
    """Return the memory of this machine [bytes], inf where the system does not tell."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE")) * float(os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):
        return float("inf")
