"""Gains of `RobustFONFTSM`, and the numbers that follow from the arm and the period of a tick."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.control.approach import speed_of_limits
from fotsmc_pin.control.gains import DERIVED, Gains, flag, per_joint, scalar
from fotsmc_pin.control.inertia_floor import largest_floor
from fotsmc_pin.control.rotor_search import doubtful_rotor, largest_rotor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

LONGEST_TICK_AT_FULL_SPEED = 1.44e-3
"""The default rates suit ticks up to this; longer ones slow them in proportion [s]."""
APPROACH = 0.9
"""Share of a joint's velocity limit at which a large error is closed."""
WIDEST_REACH = 0.25
"""Reach where no velocity limit asks for less [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RobustFONFTSMGains(Gains):
    """Gains of `RobustFONFTSM`, all in joint units: none depends on the arm's inertia.

    Attributes:
        bandwidth: one factor on all rates of the loop; less than 1 for elastic joints, noisy
            sensors or slow drives. Where `dt` is above 1.44 ms all rates are slowed in proportion
            besides. The numbers below are those at `bandwidth` 1.
        alpha: order `α` of the surface and of the integral; with 0 the law is of integer order.
        tempering: `σ`; both operators fade with `e^{-σt}`, so that errors die exponentially and not
            like a power of time. 0 is the paper's.
        A: linear gain of the surface.
        lam: gain `λ` of the terminal term.
        power: `p/q`, between 1 and 2 as the paper's proof demands.
        reach: error `ē` beyond which the surface asks for no more speed, so that a large start
            error takes no large torque. By default `reach_of_limits`.
        approach: speed `v_a` at which an error is closed that is larger than about `v_a / 100 s`;
            inf leaves it to the surface. By default 0.8 of the arm's velocity limits.
        approach_rate: rate `ω_g` at which such a way ends.
        theta: gain `Θ` of the reaching law.
        mu: power `μ` of the reaching law.
        integral: rate `b` of the integral that stands in place of a sign; 0 switches it off.
        boundary_layer: `φ`, the distance from the surface at which the integral works hardest.
        observer: bandwidth `K` of the disturbance observer; 0 switches it off.
        rotor_limit: bound of the rotor inertia that is found from oscillation; 0 switches the
            search off. By default `largest_rotor` of the arm.
        rotor_doubt: bound of the part that is found as a joint brakes on its way home; 0 leaves it
            to oscillation. By default three times the model's armature.
        floor_share: how much inertia is added per disturbance torque; 0 switches the floor off.
        floor_rate: bandwidth `ω_f` of the torque that the added inertia asks for.
        floor_limit: the most that is added. By default `largest_floor` of the arm.
        anti_windup: whether torque limits hold back the law's three memories.
        memory_horizon: time over which the operators' memory is certified [s].
    """

    bandwidth: float = scalar(1.0, above=0.0)
    alpha: float = scalar(0.3, at_least=0.0, below=1.0)
    tempering: float = scalar(14.0, "1/s", at_least=0.0)
    A: Array = per_joint(28.0, "s^-(1+α)", above=0.0)
    lam: Array = per_joint(2.0, "rad^(1-p/q) s^-(1+α)", at_least=0.0)
    power: float = scalar(1.1, above=1.0, below=2.0)
    reach: Array = per_joint(DERIVED, "rad", above=0.0)
    approach: Array = per_joint(DERIVED, "rad/s", above=0.0, unlimited=True)
    approach_rate: Array = per_joint(8.0, "1/s", above=0.0)

    theta: Array = per_joint(21.0, "1/s", above=0.0)
    mu: float = scalar(0.99, above=0.0, below=1.0)
    integral: Array = per_joint(50.0, "rad s^-(3+α)", at_least=0.0)
    boundary_layer: Array = per_joint(0.05, "rad s^-(1+α)", above=0.0)
    observer: Array = per_joint(88.0, "rad/s", at_least=0.0)
    rotor_limit: Array = per_joint(DERIVED, "kg·m²", at_least=0.0, unlimited=True)
    rotor_doubt: Array = per_joint(DERIVED, "kg·m²", at_least=0.0)
    floor_share: Array = per_joint(0.16, "s²/rad", at_least=0.0)
    floor_rate: Array = per_joint(25.0, "rad/s", above=0.0)
    floor_limit: Array = per_joint(DERIVED, "kg·m²", at_least=0.0, unlimited=True)
    anti_windup: bool = flag(True)
    memory_horizon: float = scalar(1e3, "s", above=0.0, tuned=False)

    @classmethod
    def derive(cls, arm: Arm, dt: float, known: Mapping[str, Any]) -> dict[str, Any]:
        """Return what follows from the arm's velocity and effort limits."""
        given = {name: known[name] for name in ("bandwidth", "alpha", "tempering", "A", "lam")}
        return {
            "reach": reach_of_limits(arm=arm, dt=dt, **given),
            "approach": speed_of_limits(arm),
            "floor_limit": largest_floor(arm),
            "rotor_limit": largest_rotor(arm),
            "rotor_doubt": doubtful_rotor(arm),
        }


def rate_factor(bandwidth: float, dt: float) -> float:
    """Return the factor on all rates.

    A loop that acts `1.5 dt` late, by the hold and one tick of delay, bears rates in proportion to
    `1 / dt`: beyond 1.44 ms all are slowed by one factor, beside `bandwidth`.
    """
    return bandwidth * min(1.0, LONGEST_TICK_AT_FULL_SPEED / dt)


def reach_of_limits(
    *, arm: Arm, dt: float, bandwidth: float, alpha: float, tempering: float, A: Array, lam: Array
) -> Array:
    """Return `ē` (nv,) [rad] with which a large error is closed within the velocity limits.

    On the surface, far away, `D^{α,σ} ė = -(A ē + λ ē^{p/q})`, and of a constant speed the tempered
    derivative becomes `σ^α ė`: the speed is `(A ē + λ ē^{p/q}) / σ^α`. As `λ ē^{p/q} ≤ λ ē` for
    `ē ≤ 1 rad`, `ē = 0.9 v_max σ^α / (A + λ)` keeps it below the limit, and 0.25 rad is the most.
    Without tempering the derivative of a constant speed fades away; `σ = 1` replaces it, which
    holds it for the first second.
    """
    factor = rate_factor(bandwidth, dt)
    surface = factor ** (1.0 + alpha)
    allowed = APPROACH * arm.velocity_limit * max(tempering * factor, 1.0) ** alpha
    reach: Array = np.minimum(allowed / (A * surface + lam * surface), WIDEST_REACH)
    return reach


def scaled(gains: RobustFONFTSMGains, dt: float) -> RobustFONFTSMGains:
    """Return the gains with every rate scaled by `bandwidth`, and slowed for long ticks.

    With time measured in units of `1 / rate_factor` the law stays the same; a gain counts that unit
    as often as its own unit says.
    """
    factor = rate_factor(gains.bandwidth, dt)
    surface = factor ** (1.0 + gains.alpha)
    return replace(
        gains,
        tempering=gains.tempering * factor,
        A=gains.A * surface,
        lam=gains.lam * surface,
        theta=gains.theta * factor,
        approach_rate=gains.approach_rate * factor,
        integral=gains.integral * factor ** (3.0 + gains.alpha),
        boundary_layer=gains.boundary_layer * surface,
        observer=gains.observer * factor,
        floor_rate=gains.floor_rate * factor,
    )
