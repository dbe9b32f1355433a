"""Elastic joints in the suite: a warning before a run, an observer, and the speed that it bears."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis import (
    OBSERVED_SHARE,
    largest_bandwidth,
    warn_of_soft_joints,
    with_bandwidth,
)
from fotsmc_pin.control import SpringObserver
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import ModelLearning

if TYPE_CHECKING:
    from typing import Any

    from fotsmc_pin.control import Controller
    from fotsmc_pin.evaluation.stress.scenario import Scenario


def fitted_to_springs(
    controller: Controller[Any], scenario: Scenario
) -> Controller[Any] | SpringObserver:
    """Return the controller that a scenario is run with, and warn where it was too fast for it.

    On elastic joints a `SpringObserver` for the side of the encoders goes around the law. It knows
    what a maker states, the stiffness of the springs, and the rotors of the nominal arm, which are
    not the true ones. A law with a `bandwidth` then runs at `OBSERVED_SHARE` of what
    `largest_bandwidth` gives, and never faster than it was made. On a rigid arm the controller is
    returned as it is.

    Args:
        controller: as it was made for the scenario.
        scenario: what it is to be run in.

    Warns:
        BandwidthWarning: as it was made, the controller is too fast for the springs.
    """
    true, side = scenario.true, scenario.encoder
    if not np.isfinite(true.joint_stiffness).any():
        return controller
    warn_of_soft_joints(controller, true, encoder=side, delay=scenario.delay)
    observer = SpringObserver(controller, true.joint_stiffness, encoder=side, delay=scenario.delay)
    made = getattr(controller.gains, "bandwidth", None)
    if made is None:
        return observer
    try:
        edge = largest_bandwidth(observer, delay=scenario.delay)
    except ArgumentError:  # no bandwidth is stable: run it as it is
        return observer
    return with_bandwidth(observer, min(made, OBSERVED_SHARE[side] * edge))


def with_learning(
    controller: Controller[Any] | SpringObserver, delay: int
) -> ModelLearning | SpringObserver:
    """Return a controller that learns its model, inside of the observer where there is one."""
    if isinstance(controller, SpringObserver):
        return controller.around(ModelLearning(controller.law, delay=delay))
    return ModelLearning(controller, delay=delay)
