"""`MujocoRobot`: an arm in MuJoCo that moves in wall-clock time, as a robot does."""

from __future__ import annotations

import time
import xml.etree.ElementTree as ET
from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.safety import Drives
from fotsmc_pin.errors import MissingDependencyError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


LONGEST_CATCH_UP = 0.05
"""Where the program fell further behind, the plant's clock is held back [s]."""
COMPILER = {"boundinertia": "1e-9", "balanceinertia": "true", "fusestatic": "true"}


class MujocoRobot:
    """A simulated robot for `run_realtime`, with the friction, damping and armature of the arm.

    Each read advances the plant from its last time to the present, under the torque that was last
    written. Meshes and contacts are left out. Each convention of a real robot can be had, alone or
    together:

    - `compensates`: the drives add gravity, Coriolis torque or friction to what is written. They
      take the first two from `believed`, and so are wrong where that is; friction goes away.
    - `paced`: `read` blocks until the next tick is due, as the interfaces of some robots do.
    - `delay`: a torque acts so many writes later.
    - `quantisation`: positions come in steps, as of an encoder; speeds do not.

    Attributes:
        compensates: what the drives add.
        paced: whether `read` blocks until the next tick.
    """

    def __init__(
        self,
        arm: Arm,
        q0: ArrayLike,
        *,
        v0: ArrayLike | None = None,
        compensates: tuple[str, ...] = (),
        believed: Arm | None = None,
        paced: bool = False,
        period: float = 1e-3,
        delay: int = 0,
        quantisation: ArrayLike = 0.0,
        step: float = 5e-4,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Put an arm into MuJoCo.

        Args:
            arm: the true arm.
            q0: configuration at the start (nq,).
            v0: velocity at the start (nv,) [rad/s, m/s]; at rest if None.
            compensates: what the drives add: any of "gravity", "coriolis", "friction".
            believed: the arm that the drives take themselves to be on; the true one if None.
            paced: let `read` block until the next multiple of `period`.
            period: of a paced robot's tick [s].
            delay: writes from a torque to its effect.
            quantisation: step of the measured positions, one number or one per joint [rad, m]; 0
                for none.
            step: period of MuJoCo's integrator [s].
            clock: tells the time [s]; wall-clock time by default.

        Raises:
            MissingDependencyError: MuJoCo is not installed.
            ArgumentError: an unusable configuration or number.
        """
        try:
            import mujoco
        except ImportError as error:
            raise MissingDependencyError("MujocoRobot needs MuJoCo: pip install mujoco") from error
        self.arm, self._step = arm, mujoco.mj_step
        self._drives = Drives(arm if believed is None else believed, compensates)
        self.compensates, self.paced = self._drives.compensates, bool(paced)
        self._period = checks.finite_number("period", period, above=0.0)
        self._resolution = checks.per_joint("quantisation", quantisation, arm.nv, at_least=0.0)
        waiting = [np.zeros(arm.nv)] * checks.count("delay", delay, at_least=0)
        self._waiting, self._clock = deque(waiting), clock
        self._model = model = mujoco.MjModel.from_xml_string(_shapeless(arm.urdf))
        model.opt.timestep = checks.finite_number("step", step, above=0.0)
        model.opt.gravity[:] = arm.model.gravity.linear
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self._data = mujoco.MjData(model)
        names = [model.joint(number).name for number in range(model.njnt)]
        self._order = order = [arm.joint_names.index(name) for name in names]
        model.dof_armature[:] = arm.armature[order]
        # MuJoCo reads friction from the file too, so that it must be taken away where it is hidden.
        left = 0.0 if self._drives.hides_friction else 1.0
        model.dof_damping[:] = left * arm.damping[order]
        model.dof_frictionloss[:] = left * arm.friction[order]
        mujoco.mj_setConst(model, self._data)
        self._data.qpos[:] = arm.to_joint_positions(q0)[order]
        if v0 is not None:
            self._data.qvel[:] = checks.finite_vector("v0", v0, arm.nv)[order]
        self._limit = arm.effort_limit
        self._sent, self._acting = np.zeros(arm.nv), np.zeros(arm.nv)
        self._began: float | None = None
        self._due = 0.0

    def read(self) -> tuple[Array, Array]:
        """Advance the plant to the present; return `q` (nq,) and `v` (nv,).

        A paced robot waits for its next tick first.
        """
        if self.paced:
            self._wait()
        now = self._clock()
        if self._began is None:
            self._began = now
        behind = now - self._began - self._data.time
        if behind > LONGEST_CATCH_UP:
            self._began += behind - LONGEST_CATCH_UP
            behind = LONGEST_CATCH_UP
        for _ in range(int(behind / self._model.opt.timestep + 1e-6)):
            self._drive()
            self._step(self._model, self._data)
        angles, speeds = self._state()
        coarse = self._resolution > 0.0
        steps = np.where(coarse, self._resolution, 1.0)
        angles = np.where(coarse, np.round(angles / steps) * steps, angles)
        return self.arm.from_joint_positions(angles), speeds

    def write(self, tau: Array) -> None:
        """Command the torque (nv,) [N·m, N]; it is clipped to the effort limits."""
        self._waiting.append(np.clip(tau, -self._limit, self._limit))
        self._sent = self._waiting.popleft()

    def read_torque(self) -> Array:
        """Return the torque that acts at the joints (nv,), what the drives add included."""
        return self._acting.copy()

    def _state(self) -> tuple[Array, Array]:
        """Return angles and speeds (nv,), exactly."""
        angles, speeds = np.zeros(self.arm.nv), np.zeros(self.arm.nv)
        angles[self._order], speeds[self._order] = self._data.qpos, self._data.qvel
        return angles, speeds

    def _drive(self) -> None:
        """Let the drives add what they add, as fast as the plant is computed."""
        angles, speeds = self._state()
        added = self._drives.added(self.arm.from_joint_positions(angles), speeds)
        self._acting = np.clip(self._sent + added, -self._limit, self._limit)
        self._data.qfrc_applied[:] = self._acting[self._order]

    def _wait(self) -> None:
        """Block until the next tick of a paced robot; ticks that nobody read are left out."""
        now = self._clock()
        if self._due == 0.0:
            self._due = now
        while now < self._due:
            time.sleep(max(self._due - now - 2e-4, 0.0))
            now = self._clock()
        self._due += self._period * (1 + int((now - self._due) / self._period))


def _shapeless(urdf: str) -> str:
    """Return a URDF without shapes, with options for MuJoCo's compiler."""
    robot = ET.fromstring(urdf)
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", COMPILER)
    return ET.tostring(robot, encoding="unicode")
