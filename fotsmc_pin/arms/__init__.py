"""Arms: any URDF as limits and dynamics terms, where arms come from, and perturbed plants."""

from fotsmc_pin.arms.arm import Arm
from fotsmc_pin.arms.demand import demand_arm
from fotsmc_pin.arms.inspection import Inspection, inspect_arm
from fotsmc_pin.arms.known_friction import with_known_friction
from fotsmc_pin.arms.load import load_arm
from fotsmc_pin.arms.payload import Payload
from fotsmc_pin.arms.perturbation import perturb
from fotsmc_pin.arms.random_numbers import Uniform

__all__ = [
    "Arm",
    "Inspection",
    "Payload",
    "Uniform",
    "demand_arm",
    "inspect_arm",
    "load_arm",
    "perturb",
    "with_known_friction",
]
