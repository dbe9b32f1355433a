"""The loop in wall-clock time, and a plant in MuJoCo to try it on."""

from fotsmc_pin.realtime.loop import run_realtime
from fotsmc_pin.realtime.mujoco_robot import MujocoRobot
from fotsmc_pin.realtime.robot import Robot
from fotsmc_pin.realtime.run import Run
from fotsmc_pin.realtime.timing import Timing

__all__ = ["MujocoRobot", "Robot", "Run", "Timing", "run_realtime"]
