"""Types that signatures of every package share: arrays, and the callables of a simulation.

`t` is the time [s]. Configurations `q` are (nq,); velocities, accelerations and torques are (nv,).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]
"""Floats of any shape; docstrings give the shape."""

Reference: TypeAlias = Callable[[float], tuple[Array, Array, Array]]
"""`t -> (q_d, v_d, a_d)`: the desired motion as a function of time."""

Disturbance: TypeAlias = Callable[[float], ArrayLike]
"""`t -> (nv,)`: torque that is added at the joints [N·m, N]."""

Sensor: TypeAlias = Callable[[float, Array, Array], tuple[Array, Array]]
"""`(t, q, v) -> (q, v)`: from the true state to what a controller measures."""

Actuator: TypeAlias = Callable[[float, Array], Array]
"""`(t, tau) -> tau`: from the controller's torque to what the drives apply."""

PoseReference: TypeAlias = Callable[[float], tuple[Any, Array, Array]]
"""`t -> (T, V, A)`: pose (`pinocchio.SE3`), twist (6,) in its axes and the derivative of that."""
