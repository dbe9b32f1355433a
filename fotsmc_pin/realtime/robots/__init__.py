"""Adapters for robots with a torque interface; each imports its maker's library when it is used."""

from fotsmc_pin.realtime.robots.franka import Franka
from fotsmc_pin.realtime.robots.ur import UniversalRobot

__all__ = ["Franka", "UniversalRobot"]
