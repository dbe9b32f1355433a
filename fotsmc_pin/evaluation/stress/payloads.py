"""The payloads for which manufacturers rate their arms."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

RATED_PAYLOAD = {
    "panda": 3.0,
    "ur3": 3.0,
    "ur5": 5.0,
    "ur10": 10.0,
    "kinova": 1.6,
    "xarm7": 3.5,
    "z1": 2.0,
}
"""Rated payload by the arm's name, from the manufacturers' data sheets [kg]."""
SHARE_OF_MASS = 0.1
"""Payload of an arm that is not in the list, as a share of the mass of its moving links."""


def stress_payload(arm: Arm) -> float:
    """Return the arm's rated payload, or a tenth of the mass of its moving links [kg]."""
    mass = sum(float(inertia.mass) for inertia in arm.model.inertias[1:])
    return RATED_PAYLOAD.get(arm.name, SHARE_OF_MASS * mass)
