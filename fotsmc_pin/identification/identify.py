"""`identify`: the arm that explains what a robot measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.identification.base_parameters import base_of
from fotsmc_pin.identification.consistent import consistent
from fotsmc_pin.identification.described import base_rows, parameter_rows, untold
from fotsmc_pin.identification.diagnosis import demand_sense, warn_of_little, warn_of_unused
from fotsmc_pin.identification.filtering import chosen_width
from fotsmc_pin.identification.fit import fit
from fotsmc_pin.identification.prior import body_sizes, nominal_belief
from fotsmc_pin.identification.reading import read_logs
from fotsmc_pin.identification.regressor import Parameters, equations
from fotsmc_pin.identification.result import Identification
from fotsmc_pin.identification.torque import torque_check
from fotsmc_pin.identification.writing import written
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.progress import Progress

STRIBECK_VELOCITY = 0.05
"""Speed at which the friction of breakaway fades, where none is given [rad/s, m/s]."""


def identify(
    logs: Any,
    arm: Arm,
    *,
    validate: Any = (),
    offset: bool = False,
    stribeck: bool = False,
    stribeck_velocity: float = STRIBECK_VELOCITY,
    name: str | None = None,
    progress: Progress = False,
) -> Identification:
    """Return the arm that explains the torque of one or several logs.

    The equation of motion is linear in masses, first moments, inertias, armature, viscous and
    Coulomb friction: `τ = X(q, v, a) θ`. Positions are smoothed and differentiated without delay;
    torque and `X` are averaged alike over some hundredths of a second; each joint's equations are
    weighted by the noise of its residual, and the time between the stamps of torque and motion is
    found with them. Among all `θ` whose bodies can exist (positive mass, triangle inequality) the
    most likely is taken, given the log and the nominal arm: what the motion does not tell stays as
    the file has it.

    Args:
        logs: a recording, a `Log`, anything with its attributes, or a list of these. Positions and
            torque are used; velocities are only compared with the positions.
        arm: the nominal arm: geometry, and a first guess of everything else.
        validate: logs, as in `logs`, that are not fitted: the result tells how well their torque is
            predicted.
        offset: also find a constant torque of each joint (a sensor's zero, a spring). A URDF has no
            place for it; it is `Identification.offset`.
        stribeck: also find by how much friction at standstill exceeds Coulomb friction.
        stribeck_velocity: speed of its fall [rad/s, m/s].
        name: of the new arm; by default the nominal's with `_identified`.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Raises:
        ArgumentError: a log cannot be used: joints are missing, kinds of torque are mixed, too
            little moves; or what it holds is not what it should be, as `LogError` says.
        LogError: columns swapped, degrees for radians, a wrong sign, another direction of gravity,
            or torque without gravity: named, with the reason.

    Sources: Gautier, Journal of Robotic Systems, 1991 (base parameters); Janot, Vandanjon, Gautier,
    IEEE Transactions on Control Systems Technology, 2014 (filters and weights); Wensing, Kim,
    Slotine, IEEE Robotics and Automation Letters, 2018 (possible bodies).
    """
    demand_arm(arm)
    speed = checks.finite_number("stribeck_velocity", stribeck_velocity, above=0.0)
    parameters = Parameters(arm.nv, offset=offset, stribeck=stribeck)
    with reporting(progress, f"Identifying {arm.name}") as report:
        read = read_logs(arm, logs)
        held_out = read_logs(arm, validate, "validate") if any_logs(validate) else []
        for entry in (*read, *held_out):
            demand_sense(arm, entry)
        report(0.2)
        pieces = [piece for entry in read for piece in entry.pieces]
        width = chosen_width(pieces)
        systems = [equations(arm, piece, parameters, width, speed) for piece in pieces]
        warn_of_unused(arm, systems)
        report(0.5)
        belief = nominal_belief(arm, parameters)
        linear = fit(systems, belief)
        report(0.7)
        theta = consistent(linear, parameters, belief.mean, body_sizes(arm))
        base = base_of(arm, parameters)
        report(0.8)
        labels = ", ".join(entry.log.label for entry in read)
        identified = written(
            arm,
            theta,
            parameters,
            name=name or f"{arm.name}_identified",
            changes=[f"masses, inertias, armature and friction identified from {labels}"],
            stribeck_velocity=speed,
        )
        constant = theta[parameters.groups["offset"]] if offset else np.zeros(arm.nv)
        shift = dict(zip((id(piece) for piece in pieces), linear.shifts, strict=True))
        checked = [
            torque_check(arm, identified, entry, constant, width, shift)
            for entry in (*read, *held_out)
        ]
        report(1.0)
    rows = base_rows(base, belief, theta, linear.covariance)
    warn_of_little(rows)
    return Identification(
        arm=identified,
        nominal=arm,
        parameters=parameter_rows(arm, parameters, belief, theta, linear.covariance),
        base_parameters=rows,
        unidentifiable=untold(arm, base, rows, offset),
        fits=tuple(checked[: len(read)]),
        validation=tuple(checked[len(read) :]),
        noise=linear.noise,
        offset=constant,
        notes=tuple(note for entry in (*read, *held_out) for note in entry.notes),
        theta=theta,
        covariance=linear.covariance,
    )


def any_logs(logs: Any) -> bool:
    """Return whether any log was given."""
    return not (isinstance(logs, (list, tuple)) and not logs) and logs is not None
