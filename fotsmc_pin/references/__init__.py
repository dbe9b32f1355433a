"""References: desired position, velocity and acceleration as functions of time."""

from fotsmc_pin.references.hold import Hold
from fotsmc_pin.references.sinusoid import Sinusoid

__all__ = ["Hold", "Sinusoid"]
