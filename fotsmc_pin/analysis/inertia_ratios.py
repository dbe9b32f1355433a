"""`inertia_ratios`: how far the true inertia of an arm lies from the nominal one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


CONFIGURATIONS = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class InertiaRatios:
    """Generalized eigenvalues of `(M, M0)` over configurations.

    Attributes:
        lowest: smallest ratio: the direction in which the nominal arm is heaviest for the true one.
        highest: largest ratio.
        q_lowest: configuration of the smallest ratio (nq,).
        q_highest: configuration of the largest ratio (nq,).
        joint_lowest: joint that moves most in the direction of the smallest ratio.
        joint_highest: joint that moves most in the direction of the largest ratio.
        ratios: all of them, ascending in each row (configurations, nv).
    """

    lowest: float
    highest: float
    q_lowest: Array
    q_highest: Array
    joint_lowest: str
    joint_highest: str
    ratios: Array

    def __str__(self) -> str:
        """Say the range in words."""
        return (
            f"true over nominal inertia from {self.lowest:.3g} (most at {self.joint_lowest}) "
            f"to {self.highest:.3g} (most at {self.joint_highest})"
        )


def inertia_ratios(
    true: Arm, nominal: Arm, q: ArrayLike | None = None, *, seed: int = 0
) -> InertiaRatios:
    """Return the ratios `m` of true over nominal inertia.

    A law that multiplies a commanded acceleration with the nominal mass matrix `M0`, with the same
    gains at each joint, falls apart on the true arm into scalar loops, one for each solution of

        M(q) x = m M0(q) x,

    in which `m` alone stands for the arm: compare with `Margins.lowest` and `Margins.highest`.

    Args:
        true: the arm that moves.
        nominal: the arm that the law knows.
        q: configurations (n, nq); by default 200 at random inside the limits, and the neutral one.
        seed: of the random configurations.

    Raises:
        ArgumentError: the arms do not have the same joints, or a mass matrix is singular: a joint
            without any inertia.
    """
    if true.joint_names != nominal.joint_names:
        raise ArgumentError("true", true.name, f"give an arm with the joints of {nominal.name}")
    if q is None:
        rng = np.random.default_rng(checks.count("seed", seed, at_least=0))
        drawn = [nominal.random_configuration(rng) for _ in range(CONFIGURATIONS)]
        rows = [np.array(nominal.neutral), *drawn]
    else:
        rows = [checks.finite_vector("q", row, nominal.nq) for row in np.atleast_2d(q)]
    found, directions = [], []
    for row in rows:
        M, M0 = true.mass_matrix(row), nominal.mass_matrix(row)
        try:
            m, x = scipy.linalg.eigh(M, M0)
        except np.linalg.LinAlgError:
            remedy = "its mass matrix is singular; give the joints without inertia an armature"
            raise ArgumentError("nominal", nominal.name, remedy) from None
        found.append(m)
        # A direction weighs in a joint what it moves there, in units of that joint's inertia.
        directions.append(np.abs(x) * np.sqrt(np.diag(M0))[:, None])
    ratios = np.array(found)
    low, high = int(ratios[:, 0].argmin()), int(ratios[:, -1].argmax())
    return InertiaRatios(
        lowest=float(ratios[low, 0]),
        highest=float(ratios[high, -1]),
        q_lowest=rows[low],
        q_highest=rows[high],
        joint_lowest=nominal.joint_names[int(directions[low][:, 0].argmax())],
        joint_highest=nominal.joint_names[int(directions[high][:, -1].argmax())],
        ratios=ratios,
    )
