"""`Scenario`: a nominal arm, the true arm that differs from it, start, noise and delay of a run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.simulation import Encoder, NoisySensor, TickDelay, simulate

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.courses import Course
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.simulation.simulate import Law
    from fotsmc_pin.types import Array, Reference, Sensor


DT = 1e-3
POSITION_NOISE, VELOCITY_NOISE = 1e-5, 1e-3
START_ERROR = 0.2
DELAY = 1
SUBSTEPS = 2
PLANT_STEP = DT / SUBSTEPS
"""Step of the plant [s]; slower controllers do not make it longer."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenario:
    """A closed loop that is ready to be run with any controller of `arm` and `dt`.

    Attributes:
        arm: the nominal arm, which the controller knows.
        true: the arm that moves.
        course: what to follow, and where the run is judged.
        q0: configuration at the start (nq,); the arm starts at rest.
        position_noise: standard deviation [rad, m].
        velocity_noise: standard deviation [rad/s, m/s].
        bits: of encoders in place of noise and of a velocity sensor; None for those.
        encoder: side of elastic joints on which is measured, "motor" or "link".
        delay: ticks that the torque comes late.
        dt: period of a tick [s].
        substeps: of the plant in a tick.
        seed: of the noise.
        name: of the scenario.
        variant: which of the scenario's cases it is.
        text: plant and course in words.
        frictionless: the true arm without friction, where a run of it is to be compared with.
    """

    arm: Arm
    true: Arm
    course: Course
    q0: Array
    position_noise: float = POSITION_NOISE
    velocity_noise: float = VELOCITY_NOISE
    bits: int | None = None
    encoder: str = "motor"
    delay: int = DELAY
    dt: float = DT
    substeps: int = SUBSTEPS
    seed: int = 0
    name: str = "sine"
    variant: str = "raw"
    text: str = ""
    frictionless: Arm | None = None

    @property
    def reference(self) -> Reference:
        """What to follow, `t -> (q_d, v_d, a_d)`."""
        return self.course.reference

    @property
    def twin(self) -> Scenario | None:
        """The same scenario without friction, where there is one."""
        if self.frictionless is None:
            return None
        return replace(self, true=self.frictionless, frictionless=None)

    def run(self, controller: Law, duration: float | None = None) -> Recording:
        """Run a controller of the nominal arm; joints stick and slip.

        Args:
            controller: of the arm `arm`, with ticks of `dt`.
            duration: simulated time [s]; None for the course's.

        Raises:
            DivergenceError: a joint's speed exceeded every reasonable bound.
        """
        return simulate(
            self.true,
            controller,
            self.reference,
            self.course.duration if duration is None else duration,
            q0=self.q0,
            v0=np.zeros(self.arm.nv),
            sensor=self._sensor(),
            actuator=TickDelay(self.delay),
            integrator="semi-implicit",
            substeps=self.substeps,
            encoder=self.encoder,
        )

    def _sensor(self) -> Sensor:
        if self.bits is not None:
            return Encoder(self.arm, self.dt, bits=self.bits)
        return NoisySensor(
            self.arm, position=self.position_noise, velocity=self.velocity_noise, seed=self.seed
        )
