"""Arguments that have to be arms."""

from __future__ import annotations

from fotsmc_pin.arms.arm import Arm
from fotsmc_pin.checks import instance


def demand_arm(value: object, name: str = "arm") -> None:
    """Demand an arm at a public door.

    Raises:
        ArgumentError: something else was given, such as the name of an arm.
    """
    instance(name, value, Arm, "give an arm, as load_arm returns it")
