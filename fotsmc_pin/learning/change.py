"""When the arm is not what it was: a payload was picked up, or put down."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.learning.estimator import SURPRISING

if TYPE_CHECKING:
    from fotsmc_pin.learning.estimator import JointRows
    from fotsmc_pin.learning.parameters import Beliefs
    from fotsmc_pin.types import Array

PATIENCE = 0.5
"""Time between two changes [s]."""


@kernel(is_part=True)
def notice_change(settled: float, joints: JointRows, Y: Array, b: Beliefs, P: Array) -> bool:
    """Return whether a row has been surprised for long; then forget how sure the payload was.

    The payload is what changes in use. What else is surprising, a push say, the payload does not
    explain for long; the rows that it spoils are left out while it lasts (`take_row`).

    Args:
        settled: time since the last change [s].
        joints: the joints' rows; the low-pass begins anew, as rows from before tell nothing now.
        Y: low-passed rows (nv, c).
        b: the beliefs.
        P: covariance (p, p).
    """
    n, p = joints.torque.size, b.estimate.size
    if settled < PATIENCE or joints.surprise.max() < SURPRISING:
        return False
    Y[:] = 0.0
    for j in range(n):
        joints.surprise[j] = joints.smoothed[j] = joints.filtered[j] = 0.0
    for i in range(n, n + 4):
        for k in range(p):
            P[i, k] = P[k, i] = 0.0
        P[i, i] = b.deviation[i] ** 2
    return True
