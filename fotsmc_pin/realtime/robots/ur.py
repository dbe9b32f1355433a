"""`UniversalRobot`: a UR e-series arm under direct torque control at 500 Hz."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.errors import FotsmcError, MissingDependencyError

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from fotsmc_pin.types import Array

JOINTS = 6
FREQUENCY = 500.0
"""Rate of the arm's interface [Hz]."""


class RobotError(FotsmcError, RuntimeError):
    """A robot refused what it was told."""


class UniversalRobot:
    """A UR arm for `run_realtime`, by the library `ur_rtde` and its `directTorque`.

        with UniversalRobot("192.168.0.2") as robot:
            run = fp.run_realtime(controller, robot, reference, 10.0)

    The arm adds gravity, by the payload that is set in it: the nominal arm of the controller must
    carry the same. It adds friction torque too, unless that is switched off. The loop keeps the
    clock: a controller for it has `dt=2e-3`. Direct torque needs PolyScope 5.23 or later, or
    PolyScope X 10.10 or later. The interface tells no measured torques.

    It was tried against the library's signatures only, never on an arm.

    Attributes:
        compensates: gravity, and friction unless that is switched off.
        paced: False.
    """

    paced = False

    def __init__(self, address: str, *, friction: bool = True) -> None:
        """Connect to an arm; its program starts, and waits for torques.

        Args:
            address: of the arm's control box in the network.
            friction: let the arm compensate the friction of its joints, by its maker's shares.

        Raises:
            MissingDependencyError: `ur_rtde` is not installed.
            Exception: the library's own, such as that of a connection that fails.
        """
        try:
            import rtde_control
            import rtde_receive
        except ImportError as error:
            raise MissingDependencyError(
                "UniversalRobot needs ur_rtde: pip install ur_rtde"
            ) from error
        self.compensates = ("gravity", "friction") if friction else ("gravity",)
        none = {"viscous_scale": [0.0] * JOINTS, "coulomb_scale": [0.0] * JOINTS}
        self._scales = {} if friction else none
        self._state: Any = rtde_receive.RTDEReceiveInterface(address, FREQUENCY)
        self._control: Any = rtde_control.RTDEControlInterface(address, FREQUENCY)

    def __enter__(self) -> Self:
        """Return the robot."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the arm's program, on which it brakes and holds itself, and the connection."""
        self._control.stopScript()
        self._control.disconnect()
        self._state.disconnect()

    def read(self) -> tuple[Array, Array]:
        """Return the arm's latest `q` and `v` (6,).

        Raises:
            RobotError: the connection is lost; what would be returned is old.
        """
        if not self._state.isConnected():
            raise RobotError("the arm sends nothing any more: look at the network and the arm")
        return np.array(self._state.getActualQ()), np.array(self._state.getActualQd())

    def write(self, tau: Array) -> None:
        """Command the torque (6,) [N·m] without gravity.

        Raises:
            RobotError: the arm does not take it, as after a protective stop.
        """
        if not self._control.directTorque(tau.tolist(), **self._scales):
            raise RobotError("the arm takes no torque: look for a protective stop, and its version")
