"""The loop of plant, controller and reference, and the recording of what happened."""

from fotsmc_pin.simulation.actuators import TickDelay, TorqueLag, TorqueRateLimit
from fotsmc_pin.simulation.events import PlantChange
from fotsmc_pin.simulation.plant import Plant
from fotsmc_pin.simulation.recording import Recording
from fotsmc_pin.simulation.sensors import (
    Chain,
    Encoder,
    NoisySensor,
    QuantizedSensor,
    TorqueSensor,
    VelocityFromPosition,
)
from fotsmc_pin.simulation.simulate import simulate
from fotsmc_pin.simulation.wrench import Wrench

__all__ = [
    "Chain",
    "Encoder",
    "NoisySensor",
    "Plant",
    "PlantChange",
    "QuantizedSensor",
    "Recording",
    "TickDelay",
    "TorqueLag",
    "TorqueRateLimit",
    "TorqueSensor",
    "VelocityFromPosition",
    "Wrench",
    "simulate",
]
