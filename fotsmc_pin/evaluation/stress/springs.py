"""Elastic joints in the suite: the warning before a run, and the speed that their springs bear."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis import largest_bandwidth, warn_of_soft_joints
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Any

    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.stress.scenario import Scenario

SHARE = 0.9
"""Share of `largest_bandwidth` at which a law runs with encoders on the links."""


def fitted_to_springs(controller: Controller[Any], scenario: Scenario) -> Controller[Any]:
    """Return the controller that a scenario is run with, and warn where it was too fast for it.

    With encoders on the links of elastic joints a law that has a `bandwidth` runs at 0.9 of what
    `largest_bandwidth` gives for the nominal arm with its own rotors and the true springs, and
    never faster than it was made. Every other controller is returned as it is.

    Args:
        controller: as it was made for the scenario.
        scenario: what it is to be run in.

    Warns:
        BandwidthWarning: as it was made, the controller is too fast for the springs.
    """
    true, nominal, side = scenario.true, scenario.arm, scenario.encoder
    if not np.isfinite(true.joint_stiffness).any():
        return controller
    warn_of_soft_joints(controller, true, encoder=side, delay=scenario.delay)
    made = getattr(controller.gains, "bandwidth", None)
    if side == "motor" or made is None:
        return controller
    try:
        edge = largest_bandwidth(
            controller,
            true.joint_stiffness,
            rotor=nominal.armature,
            encoder=side,
            delay=scenario.delay,
        )
    except ArgumentError:  # no bandwidth is stable: run it as it is
        return controller
    given = {
        name: getattr(controller.gains, name) for name in controller.gains.__dataclass_fields__
    }
    return type(controller)(
        nominal, controller.dt, **{**given, "bandwidth": min(made, SHARE * edge)}
    )
