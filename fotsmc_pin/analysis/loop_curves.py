"""What `margins` reads off a loop, as curves: return ratio, sensitivity, growth against inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis.margins import distinct
from fotsmc_pin.analysis.sampled_loop import Joint, closed_loop, open_loop

if TYPE_CHECKING:
    from fotsmc_pin.analysis.linearization import LinearLaw
    from fotsmc_pin.analysis.margins import Margins
    from fotsmc_pin.types import Array


def return_ratio(found: Margins, rates: Array) -> Array:
    """Return `L(jω)`, (laws that differ, rates) complex, with the nominal inertia.

    The loop is cut at the torque; hold and delay are in. The sensitivity is `1 / (1 + L)`.

    Args:
        found: what `margins` returned.
        rates: below `π / dt` [rad/s].
    """
    return np.array([open_loop(law, Joint(), found.delay, rates) for law in _kinds(found)])


def growth_rates(found: Margins, m: Array) -> Array:
    """Return `ln |z| / dt` [1/s] of the mode that decays least, for each `m`; above 0 it grows.

    Args:
        found: what `margins` returned.
        m: ratios of true over nominal inertia.
    """
    worst = [
        max(
            np.log(np.abs(np.linalg.eigvals(closed_loop(law, Joint(mass=k), found.delay))).max())
            / law.dt
            for law in _kinds(found)
        )
        for k in m.tolist()
    ]
    return np.array(worst)


def _kinds(found: Margins) -> list[LinearLaw]:
    return distinct(found.laws)[1]
