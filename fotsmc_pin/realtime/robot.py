"""`Robot`: what the loop needs of a robot, and what a robot must say of itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class Robot(Protocol):
    """What the loop needs of a robot, real or simulated.

    A robot that measures torques has a method `read_torque()` besides, which returns the torque
    (nv,) at the joints, gravity included, as of the last `read`; it is recorded.

    Attributes:
        compensates: what its drives add to a commanded torque of their own accord: any of
            "gravity", "coriolis", "friction"; `()` for none.
        paced: whether `read` blocks until the robot's next tick, so that the loop must not wait.
    """

    @property
    def compensates(self) -> tuple[str, ...]:
        """What the drives add."""
        ...

    @property
    def paced(self) -> bool:
        """Whether `read` keeps the clock."""
        ...

    def read(self) -> tuple[Array, Array]:
        """Return the measured `q` (nq,) and `v` (nv,)."""
        ...

    def write(self, tau: Array) -> None:
        """Command the torque (nv,) [N·m, N], without what the drives add."""
        ...


def declared(robot: Robot) -> tuple[tuple[str, ...], bool]:
    """Return what a robot `compensates`, and whether it is `paced`.

    Raises:
        ArgumentError: it does not say so; a wrong guess would throw the arm.
    """
    kind = type(robot).__name__
    try:
        compensates = robot.compensates
    except AttributeError:
        raise ArgumentError(
            "robot",
            kind,
            'give it `compensates`, what its drives add to a torque: ("gravity",) for most arms '
            "with a torque interface, () where the commanded torque is all that acts",
        ) from None
    try:
        paced = robot.paced
    except AttributeError:
        raise ArgumentError(
            "robot",
            kind,
            "give it `paced`: True where its `read` blocks until the next tick, False where the "
            "loop is to keep the clock",
        ) from None
    if not isinstance(paced, bool):
        raise ArgumentError("robot.paced", paced, "give True or False")
    return compensates, paced
