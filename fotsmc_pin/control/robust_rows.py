"""The rows of `RobustFONFTSM`: what lives on from tick to tick, and what a tick fills."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class State(NamedTuple):
    """What lives on from tick to tick.

    Attributes:
        z: second integral, in place of the sign [rad s^-(3-α)].
        step: change of the speed error that was commanded over the last tick [rad/s].
        b: acceleration that the observer adds and `T` has not taken over [rad/s²].
        fast: command `u` above `ω_f` [rad/s²].
        last_a: commanded acceleration of the last tick [rad/s²].
        last_v: velocity of the last tick [rad/s].
        d: disturbance that the momentum observer sees [N·m].
        mean_d: lasting part of it [N·m].
        delta: floor `δ` under the inertia [kg·m²].
        rest: `ρ`, 1 where the reference rests.
        last_e_dot: speed error of the last tick [rad/s].
        last_near_dot: the same behind the leading point [rad/s].
        J: rotor inertia that was found [kg·m²].
        T: torque beyond the nominal model's [N·m].
        ticks: how many there were.
        smooth_e: smoothed error [rad].
        smooth_u: smoothed torque beside `C0 v + G0` [N·m].
        last_e: smoothed error when the joint last moved [rad].
        last_u: smoothed torque when it last moved or stuck [N·m].
        stuck_e: error at which it last stuck [rad].
        slips: slips past the goal since the reference came to rest.
        allowed: error that may be left beyond `NEAR`, where friction makes it hunt [rad].
        kept: `κ`, 1 where the error has been negligible since the reference came to rest.
        stuck: 1 where friction holds the joint.
        held: `h`, 1 where friction holds the joint near its goal.
        a_1: first stage of the band-pass of the acceleration [rad/s²].
        a_2: second stage.
        a_3: third stage.
        tau_1: first stage of the band-pass of the unexplained torque [N·m].
        tau_2: second stage.
        tau_3: third stage.
        aa: recent mean of the squared acceleration in the band.
        tt: recent mean of the squared torque in the band.
        ta: recent mean of their product.
        swings: changes of sign in the present oscillation.
        peak: largest acceleration in the band since it last changed its sign [rad/s²].
        last_moved: acceleration in the band at the last tick [rad/s²].
        lacking: torque that the model leaves unexplained over the last tick [N·m].
        a_e: acceleration beyond the reference's over the last tick [rad/s²].
        way: way `e_g` from the reference to the point that leads the joint home [rad].
        way_speed: its rate [rad/s].
    """

    z: Array
    step: Array
    b: Array
    fast: Array
    last_a: Array
    last_v: Array
    d: Array
    mean_d: Array
    delta: Array
    rest: Array
    last_e_dot: Array
    last_near_dot: Array
    J: Array
    T: Array
    ticks: Array
    smooth_e: Array
    smooth_u: Array
    last_e: Array
    last_u: Array
    stuck_e: Array
    slips: Array
    allowed: Array
    kept: Array
    stuck: Array
    held: Array
    a_1: Array
    a_2: Array
    a_3: Array
    tau_1: Array
    tau_2: Array
    tau_3: Array
    aa: Array
    tt: Array
    ta: Array
    swings: Array
    peak: Array
    last_moved: Array
    lacking: Array
    a_e: Array
    way: Array
    way_speed: Array


class Work(NamedTuple):
    """What one tick fills.

    Attributes:
        near: error `ε` behind the point that leads the joint home; `e` where it is small [rad].
        near_dot: its rate `ε̇` [rad/s].
        near_a_d: acceleration of that point [rad/s²].
        passing: error at which the inertia floor takes what a joint meets for passing [rad].
        more: acceleration that another law's torque added over the last tick [rad/s²].
        S: sliding variable [rad s^-(1+α)].
        w: integrand of the fractional integral.
        a: commanded acceleration [rad/s²].
        missed: what was commanded and not done over the last tick, times `K`;
            then what `T` takes over [rad/s²].
        u: acceleration that is asked for [rad/s²].
        excess: torque beside `M0 a`; then what was cut off [N·m].
        push: torque beside `C0 v + G0` [N·m].
        inertia: the joint's own, with what is added [kg·m²].
    """

    near: Array
    near_dot: Array
    near_a_d: Array
    passing: Array
    more: Array
    S: Array
    w: Array
    a: Array
    missed: Array
    u: Array
    excess: Array
    push: Array
    inertia: Array
