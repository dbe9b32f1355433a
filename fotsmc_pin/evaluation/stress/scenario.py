"""`Scenario`: a nominal arm, the true arm that differs from it, start, noise and delay of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import perturb
from fotsmc_pin.control import warn_of_gravity
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import NoisySensor, TickDelay, simulate

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array, Reference


DT = 1e-3
DURATION = 6.0
MASS_SCALE = 1.3
FRICTION = 0.5
"""Coulomb [N·m] and viscous [N·m·s/rad] friction of a joint of at least `FULL_EFFORT`."""
FULL_EFFORT = 20.0
"""Effort limit below which a joint's friction is scaled down in proportion [N·m]."""
POSITION_NOISE, VELOCITY_NOISE = 1e-5, 1e-3
START_ERROR = 0.2
DELAY = 1
SUBSTEPS = 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenario:
    """A closed loop that is ready to be run with any controller of `arm`.

    Attributes:
        arm: the nominal arm, which the controller knows.
        true: the arm that moves.
        reference: what to follow, `t -> (q_d, v_d, a_d)`.
        q0: configuration at the start (nq,); the arm starts at rest.
        position_noise: standard deviation [rad, m].
        velocity_noise: standard deviation [rad/s, m/s].
        delay: of the torque, in ticks.
        seed: of the noise.
    """

    arm: Arm
    true: Arm
    reference: Reference
    q0: Array
    position_noise: float = POSITION_NOISE
    velocity_noise: float = VELOCITY_NOISE
    delay: int = DELAY
    seed: int = 0

    def run(self, controller: Controller, duration: float = DURATION) -> Recording:
        """Run a controller of the nominal arm; joints stick and slip.

        Args:
            controller: of the arm `arm`.
            duration: simulated time [s].

        Raises:
            DivergenceError: a joint's speed exceeded every reasonable bound.
        """
        return simulate(
            self.true,
            controller,
            self.reference,
            duration,
            q0=self.q0,
            v0=np.zeros(self.arm.nv),
            sensor=NoisySensor(
                self.arm,
                position=self.position_noise,
                velocity=self.velocity_noise,
                seed=self.seed,
            ),
            actuator=TickDelay(self.delay),
            integrator="semi-implicit",
            substeps=SUBSTEPS,
        )


def stress_scenario(arm: Arm, *, payload: float | None = None, seed: int = 0) -> Scenario:
    """Return the stress scenario of an arm.

    The plant has 30 % more mass in each link, the rated payload of the arm (or a tenth of its mass)
    at the tool, and 0.5 N·m Coulomb and 0.5 N·m·s/rad viscous friction in each joint; a joint whose
    effort limit is below 20 N·m has less of both, in proportion. Noise of 1e-5 rad and 1e-3 rad/s
    is on the measurements, the torque comes one tick late, every joint starts 0.2 rad off. The
    reference swings each joint inside the limits of the nominal arm.

    Args:
        arm: the nominal arm.
        payload: mass at the tool [kg]; None for the rated one.
        seed: of the noise.

    Warns:
        GravityWarning: gravity asks the arm for more than its effort limits.
    """
    warn_of_gravity(arm)
    reference = Sinusoid.inside_limits(arm)
    friction = (FRICTION * np.minimum(1.0, arm.effort_limit / FULL_EFFORT)).tolist()
    mass = stress_payload(arm) if payload is None else payload
    return Scenario(
        arm=arm,
        true=perturb(
            arm,
            mass_scale=MASS_SCALE,
            payload=checks.finite_number("payload", mass, at_least=0.0),
            friction=friction,
            damping=friction,
        ),
        reference=reference,
        q0=arm.integrate(reference(0.0)[0], np.full(arm.nv, START_ERROR)),
        seed=checks.count("seed", seed, at_least=0),
    )
