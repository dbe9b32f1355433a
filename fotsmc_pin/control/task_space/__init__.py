"""Laws at the tool: their reference is a pose, their error lies on SE(3)."""

from fotsmc_pin.control.task_space.impedance import CartesianImpedance
from fotsmc_pin.control.task_space.task_space import TaskSpace

__all__ = ["CartesianImpedance", "TaskSpace"]
