"""A recording from rows of a run on a robot, finished or not."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms import Arm
from fotsmc_pin.simulation.journal import read_journal
from fotsmc_pin.simulation.recorder import tracking_errors
from fotsmc_pin.simulation.recording import Recording

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import IO

    from fotsmc_pin.types import Array

FIELDS = ("t", "q", "v", "q_d", "v_d", "tau", "tau_measured")
"""Columns that are fields of a recording; others are signals."""
UNFINISHED = "the program ended before the run did"


def measured_run(
    arm: Arm, columns: Mapping[str, int], rows: Array, metadata: Mapping[str, Any]
) -> Recording:
    """Return the recording of a run on a robot.

    Args:
        arm: the nominal arm.
        columns: widths of the columns, by name and in their order.
        rows: the numbers (N, width).
        metadata: of the recording.
    """
    ends = np.cumsum([0, *columns.values()]).tolist()
    parts = {
        name: rows[:, start:end] for name, (start, end) in zip(columns, pairwise(ends), strict=True)
    }
    q, v, q_d, v_d = (parts[name] for name in ("q", "v", "q_d", "v_d"))
    return Recording(
        t=parts["t"][:, 0],
        q=q,
        v=v,
        q_d=q_d,
        v_d=v_d,
        e=tracking_errors(arm, q_d, q),
        e_dot=v - v_d,
        tau=parts["tau"],
        tau_measured=parts.get("tau_measured"),
        signals={name: part for name, part in parts.items() if name not in FIELDS},
        arm=arm,
        metadata=dict(metadata),
    )


def unfinished_run(stream: IO[bytes]) -> Recording:
    """Return the recording of a run from the journal that it left behind.

    Raises:
        RecordingError: the journal is damaged.
    """
    about, reason, rows = read_journal(stream)
    rec = measured_run(Arm.from_dict(about["arm"]), about["columns"], rows, about["metadata"])
    return replace(rec, metadata=rec.metadata | {"stopped": reason or UNFINISHED})
