"""`ChangingPlant`: a plant that becomes another arm at given times."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.simulation.dry_friction import SLIDES
from fotsmc_pin.simulation.plant import FRICTION_WIDTH, Plant
from fotsmc_pin.simulation.stages import CONSTANTS, TABLE, WIDTH

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation.events import PlantChange
    from fotsmc_pin.types import Array

PARTS_OF_AN_ARM = (
    *("_model", "_data", "_acceleration", "_wrenches", "_is_pushed"),
    *("_advance", "_links", "_of_links", "_glide"),
)
"""What a plant reads of its arm beside the constants in its workspace."""
EARLY = 1e-6
"""Share of a step by which a step may begin before an event and still be the one at its time."""


class ChangingPlant(Plant):
    """A plant whose arm changes at the first step of the integrator at or after each event's time.

    Position and velocity go on without a step, and so do springs' deflections. All arms are built
    before the run begins, so that no tick is slower than the others.
    """

    def __init__(
        self,
        arm: Arm,
        q0: Array,
        v0: Array,
        *,
        events: Sequence[PlantChange],
        integrator: str | None = None,
        **options: Any,
    ) -> None:
        """Put the arm at `q0`, `v0` at time 0; one integrator must suit the arms of all `events`.

        Args:
            arm: the true arm at the start.
            q0: configuration (nq,).
            v0: velocity (nv,).
            events: what it becomes, in the order of time.
            integrator: as of `Plant`; by default "rk4", unless any of the arms asks for the other.
            **options: as of `Plant`.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
            UrdfError: a joint of an arm moves no inertia.
        """

        def built(integrator: str | None) -> list[Plant]:
            return [Plant(e.arm, q0, v0, integrator=integrator, **options) for e in events]

        super().__init__(arm, q0, v0, integrator=integrator, **options)
        later = built(integrator)
        wanted = {plant.integrator for plant in (self, *later)}
        if len(wanted) > 1:
            super().__init__(arm, q0, v0, integrator="semi-implicit", **options)
            later = built("semi-implicit")
        self._later = [(e.time, plant) for e, plant in zip(events, later, strict=True)]
        self._next = self._later[0][0]
        self._h = options["dt"] / self._substeps

    def load(self, t: float, tau: Array) -> None:
        """Apply `tau` as `Plant.load` does, to the arm that the plant is at time `t`."""
        self._change(t)
        super().load(t, tau)

    def hold(self, t: float, dt: float) -> int:
        """Hold the torque as `Plant.hold` does, and change at the step that an event asks for."""
        h = dt / self._substeps
        for k in range(self._substeps):
            self._change(t + k * h)
            lost = self._advance(self, t + k * h, h)
            if lost >= 0:
                return lost
        return -1

    def _change(self, t: float) -> None:
        while t >= self._next - EARLY * self._h:
            _, other = self._later.pop(0)
            self._next = self._later[0][0] if self._later else math.inf
            self._become(other)

    def _become(self, other: Plant) -> None:
        """Go on from this state as the arm of another plant, which has the same joints."""
        for name in PARTS_OF_AN_ARM:
            setattr(self, name, getattr(other, name))
        work, arm = self._work, other._arm
        work[CONSTANTS] = other._work[CONSTANTS]
        impulse = arm.friction * arm.stiction * self._h
        work[WIDTH] = np.maximum(FRICTION_WIDTH, impulse / self._lightest(self.q))
        if other.joints is not None:
            self._parts = (other.joints.mass, other.joints.bias, work)
            speed = self.encoders()[1] if self.is_elastic else self.v
            work[TABLE][SLIDES] = np.sign(speed)  # Guess anew, as at a start.
        self._begin(work)
