"""`Franka`: a Franka arm (Panda, FR3) under torque control at 1 kHz."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import MissingDependencyError

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from fotsmc_pin.types import Array

JOINTS = 7


class Franka:
    """A Franka arm for `run_realtime`, by its maker's library `pylibfranka`.

        with Franka("172.16.0.2") as robot:
            run = fp.run_realtime(controller, robot, reference, 10.0)

    The arm adds gravity and its own friction to what it is sent, and its `read` blocks until the
    next tick of 1 ms: a controller for it has `dt=1e-3`. Gravity is that of the arm, of the end
    effector that is set in its settings, and of the load told by `set_load`: the nominal arm of the
    controller must carry the same. The arm aborts where a commanded torque changes by more than
    1000 N·m/s (`kMaxTorqueRate` in libfranka's rate_limiting.h, a necessary condition in Franka's
    "Control Interface Specification"): give the `Safeguard` a `torque_rate` of at most 900.

    It was tried against the library's signatures only, never on an arm.

    Attributes:
        compensates: gravity and friction.
        paced: True.
    """

    compensates = ("gravity", "friction")
    paced = True

    def __init__(
        self,
        address: str,
        *,
        realtime: bool = True,
        contact_torque: float | None = None,
        contact_force: float | None = None,
    ) -> None:
        """Connect to an arm, without beginning to control it.

        Args:
            address: of the arm's control unit in the network.
            realtime: refuse to run without a real-time kernel.
            contact_torque: joint torque from outside at which the arm stops itself [N·m]; as it is
                set in the arm if None.
            contact_force: the same of the force at the end effector [N, N·m].

        Raises:
            MissingDependencyError: `pylibfranka` is not installed.
            ArgumentError: only one of the two limits of contact, or one that is not above 0.
            Exception: the library's own, such as that of a connection that fails.
        """
        try:
            import pylibfranka
        except ImportError as error:
            raise MissingDependencyError(
                "Franka needs pylibfranka: pip install pylibfranka"
            ) from error
        limits = (contact_torque, contact_force)
        thresholds = []
        if limits != (None, None):
            named = zip(("contact_torque", "contact_force"), limits, (JOINTS, 6), strict=True)
            thresholds = [
                [checks.finite_number(name, float("nan") if limit is None else limit, above=0.0)]
                * n
                for name, limit, n in named
            ]
        config = pylibfranka.RealtimeConfig
        self._library: Any = pylibfranka
        self._robot: Any = pylibfranka.Robot(
            address, config.kEnforce if realtime else config.kIgnore
        )
        if thresholds:
            torques, forces = thresholds
            self._robot.set_collision_behavior(torques, torques, forces, forces)
        self._control: Any = None
        self._measured = np.zeros(JOINTS)

    def __enter__(self) -> Self:
        """Begin torque control; the arm holds its weight."""
        self._control = self._robot.start_torque_control()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End torque control; the arm then holds itself by its own controller."""
        self._control = None
        self._robot.stop()

    def read(self) -> tuple[Array, Array]:
        """Wait for the arm's next tick; return `q` and `v` (7,)."""
        state, _ = self._control.readOnce()
        self._measured = np.array(state.tau_J)
        return np.array(state.q), np.array(state.dq)

    def write(self, tau: Array) -> None:
        """Command the torque (7,) [N·m] without gravity; it answers the last `read`."""
        self._control.writeOnce(self._library.Torques(tau.tolist()))

    def read_torque(self) -> Array:
        """Return what the joints' torque sensors read (7,) [N·m], gravity included."""
        return self._measured
