"""The loop of plant, controller and reference, and the recording of what happened."""

from fotsmc_pin.simulation.actuators import TickDelay, TorqueLag, TorqueRateLimit
from fotsmc_pin.simulation.plant import Plant
from fotsmc_pin.simulation.recording import Recording
from fotsmc_pin.simulation.sensors import (
    Chain,
    Encoder,
    NoisySensor,
    QuantizedSensor,
    VelocityFromPosition,
)
from fotsmc_pin.simulation.simulate import simulate

__all__ = [
    "Chain",
    "Encoder",
    "NoisySensor",
    "Plant",
    "QuantizedSensor",
    "Recording",
    "TickDelay",
    "TorqueLag",
    "TorqueRateLimit",
    "VelocityFromPosition",
    "simulate",
]
