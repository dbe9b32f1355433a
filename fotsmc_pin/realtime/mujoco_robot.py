"""`MujocoRobot`: an arm in MuJoCo that moves in wall-clock time, as a robot does."""

from __future__ import annotations

import time
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import MissingDependencyError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


LONGEST_CATCH_UP = 0.05
"""Where the program fell further behind, the plant's clock is held back [s]."""
COMPILER = {"boundinertia": "1e-9", "balanceinertia": "true", "fusestatic": "true"}


class MujocoRobot:
    """A simulated robot for `run_realtime`, with the friction, damping and armature of the arm.

    Each read advances the plant from its last time to the present, under the torque that was last
    written. Meshes and contacts are left out.

    Args:
        arm: the true arm.
        q0: configuration at the start (nq,).
        step: period of MuJoCo's integrator [s].

    Raises:
        MissingDependencyError: MuJoCo is not installed.
        ArgumentError: an unusable configuration or step.
    """

    def __init__(self, arm: Arm, q0: ArrayLike, *, step: float = 5e-4) -> None:
        try:
            import mujoco
        except ImportError as error:
            raise MissingDependencyError("MujocoRobot needs MuJoCo: pip install mujoco") from error
        self.arm, self._step = arm, mujoco.mj_step
        self._model = model = mujoco.MjModel.from_xml_string(_shapeless(arm.urdf))
        model.opt.timestep = checks.finite_number("step", step, above=0.0)
        model.opt.gravity[:] = arm.model.gravity.linear
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self._data = mujoco.MjData(model)
        names = [model.joint(number).name for number in range(model.njnt)]
        self._order = order = [arm.joint_names.index(name) for name in names]
        model.dof_armature[:] = arm.armature[order]
        model.dof_damping[:] = arm.damping[order]
        model.dof_frictionloss[:] = arm.friction[order]
        mujoco.mj_setConst(model, self._data)
        self._data.qpos[:] = arm.to_joint_positions(q0)[order]
        self._limit = arm.effort_limit
        self._began: float | None = None

    def read(self) -> tuple[Array, Array]:
        """Advance the plant to the present; return `q` (nq,) and `v` (nv,)."""
        now = time.perf_counter()
        if self._began is None:
            self._began = now
        behind = now - self._began - self._data.time
        if behind > LONGEST_CATCH_UP:
            self._began += behind - LONGEST_CATCH_UP
            behind = LONGEST_CATCH_UP
        for _ in range(int(behind / self._model.opt.timestep)):
            self._step(self._model, self._data)
        angles, speeds = np.zeros(self.arm.nv), np.zeros(self.arm.nv)
        angles[self._order], speeds[self._order] = self._data.qpos, self._data.qvel
        return self.arm.from_joint_positions(angles), speeds

    def write(self, tau: Array) -> None:
        """Command the torque (nv,) [N·m, N]; it is clipped to the effort limits."""
        self._data.qfrc_applied[:] = np.clip(tau, -self._limit, self._limit)[self._order]


def _shapeless(urdf: str) -> str:
    """Return a URDF without shapes, with options for MuJoCo's compiler."""
    robot = ET.fromstring(urdf)
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", COMPILER)
    return ET.tostring(robot, encoding="unicode")
