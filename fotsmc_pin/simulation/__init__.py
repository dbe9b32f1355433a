"""The loop of plant, controller and reference, and the recording of what happened."""

from fotsmc_pin.simulation.plant import Plant
from fotsmc_pin.simulation.recording import Recording
from fotsmc_pin.simulation.simulate import simulate

__all__ = ["Plant", "Recording", "simulate"]
