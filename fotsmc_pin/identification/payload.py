"""`identify_payload`: what the tool of a known arm holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms import Payload, demand_arm, perturb
from fotsmc_pin.errors import LogError
from fotsmc_pin.identification.consistent import nearest, pulled_inside
from fotsmc_pin.identification.diagnosis import demand_sense
from fotsmc_pin.identification.filtering import chosen_width
from fotsmc_pin.identification.fit import fit
from fotsmc_pin.identification.identify import STRIBECK_VELOCITY, any_logs, identify
from fotsmc_pin.identification.prior import HELD_AT, Belief, held_modes, nominal_belief
from fotsmc_pin.identification.reading import read_logs
from fotsmc_pin.identification.regressor import Parameters, equations
from fotsmc_pin.identification.result import Identification, TorqueCheck
from fotsmc_pin.identification.torque import torque_check
from fotsmc_pin.progress import reporting

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.progress import Progress
    from fotsmc_pin.types import Array

KNOWN_LINKS = 0.005
"""Standard deviation of a link's mass over that of the file, where the arm counts as known."""
HEAVIEST = 0.5
"""Standard deviation of the payload's mass over the mass of the moving links."""
LIGHTEST = 1e-3
"""Mass that is always believed to be there: a body needs some [kg]."""
NOTHING = 3.0
"""Standard deviations that the mass must be away from zero for something to be held."""


@dataclass(frozen=True, kw_only=True, eq=False)
class IdentifiedPayload:
    """What a tool holds.

    Attributes:
        mass: [kg].
        com: centre of mass in the tool frame (3,) [m].
        inertia: about that centre, in the tool frame's axes (3, 3) [kg·m²]. A motion shows it badly
            where the payload is small.
        mass_deviation: standard deviation of the mass [kg].
        com_deviation: of the centre (3,) [m].
        arm: the arm with this payload.
        fits: measured against predicted torque of each log.
        notes: what was decided, in plain words.
    """

    mass: float
    com: Array
    inertia: Array
    mass_deviation: float
    com_deviation: Array
    arm: Arm
    fits: tuple[TorqueCheck, ...]
    notes: tuple[str, ...]

    @property
    def payload(self) -> Payload:
        """The payload, for `perturb`."""
        return Payload(mass=self.mass, com=self.com, inertia=self.inertia)

    def __str__(self) -> str:
        """Return mass and centre with their standard deviations."""
        x, y, z = (1e3 * self.com).tolist()
        dx, dy, dz = (1e3 * self.com_deviation).tolist()
        return (
            f"mass {self.mass:.4g} ± {self.mass_deviation:.2g} kg, centre of mass ({x:.1f} ± "
            f"{dx:.1f}, {y:.1f} ± {dy:.1f}, {z:.1f} ± {dz:.1f}) mm in {self.arm.tool_frame}"
        )


def identify_payload(
    logs: Any,
    arm: Arm | Identification,
    *,
    empty: Any = (),
    progress: Progress = False,
) -> IdentifiedPayload:
    """Return mass, centre of mass and inertia of what the tool holds.

    The arm counts as known: its links to half a per cent of their masses, or as an identification
    left them. What rubs and turns with the motors is not: friction and rotors are fitted beside the
    payload, and left out of the result.

    An error of the arm's own masses goes into the payload. Where the arm's file is not trusted,
    give logs of the empty arm too (`empty`), or an `Identification` of it.

    Args:
        logs: of the arm with its payload; see `identify`.
        arm: the arm without it, or what `identify` found of it.
        empty: logs of the arm without the payload, from which the arm is identified first.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Raises:
        ArgumentError: a log cannot be used; see `identify`.
        LogError: a log is not what it should be, or shows too little to tell that anything is held.
    """
    if any_logs(empty):
        arm = identify(empty, _plain(arm))
    nominal = _plain(arm)
    demand_arm(nominal)
    parameters = Parameters(nominal.nv)
    with reporting(progress, f"Weighing the payload of {nominal.name}") as report:
        read = read_logs(nominal, logs)
        for entry in read:
            demand_sense(nominal, entry)
        report(0.3)
        pieces = [piece for entry in read for piece in entry.pieces]
        width = chosen_width(pieces)
        systems = [
            equations(nominal, piece, parameters, width, STRIBECK_VELOCITY) for piece in pieces
        ]
        report(0.6)
        known = _known(arm, parameters)
        held = _held(nominal, parameters)
        both = Belief(mean=known.mean, covariance=known.covariance + held)
        linear = fit(systems, both)
        # What of the change the payload is, given what else may have changed.
        tool = _tool_body(nominal, parameters)
        gain = held[tool] @ np.linalg.inv(both.covariance)
        found = gain @ (linear.theta - known.mean)
        left = held[tool][:, tool] - gain @ held[:, tool]
        covariance = left + gain @ linear.covariance @ gain.T
        body = _possible(nominal, found, covariance)
        report(0.8)
        frame = nominal.model.frames[nominal.tool_frame_id].placement
        inertia = frame.actInv(pin.Inertia.FromDynamicParameters(body))
        mass_deviation = float(np.sqrt(covariance[0, 0]))
        if body[0] < NOTHING * mass_deviation:
            raise LogError(
                "motion",
                f"the log does not tell that anything is held: mass {body[0]:.2g} ± "
                f"{mass_deviation:.2g} kg; hold something, or move more against gravity",
            )
        moment = np.sqrt(
            np.diag(frame.rotation.T @ _centre_covariance(body, covariance) @ frame.rotation)
        )
        about = np.array(inertia.inertia)
        payload = Payload(
            mass=float(inertia.mass), com=np.array(inertia.lever), inertia=0.5 * (about + about.T)
        )
        loaded = perturb(nominal, payload=payload, name=f"{nominal.name}_loaded")
        shift = dict(zip((id(piece) for piece in pieces), linear.shifts, strict=True))
        own = linear.theta[10 * nominal.nv :].clip(min=0.0).reshape(3, -1)
        shown = perturb(loaded, armature=own[0], damping=own[1], friction=own[2])
        fits = [
            torque_check(nominal, shown, entry, np.zeros(nominal.nv), width, shift)
            for entry in read
        ]
        report(1.0)
    return IdentifiedPayload(
        mass=float(inertia.mass),
        com=np.array(inertia.lever),
        inertia=0.5 * (about + about.T),
        mass_deviation=mass_deviation,
        com_deviation=moment,
        arm=loaded,
        fits=tuple(fits),
        notes=tuple(note for entry in read for note in entry.notes),
    )


def _plain(arm: Arm | Identification) -> Arm:
    return arm.arm if isinstance(arm, Identification) else arm


def _known(arm: Arm | Identification, parameters: Parameters) -> Belief:
    """Return what is known of the arm without payload."""
    if isinstance(arm, Identification):
        size = parameters.size
        return Belief(mean=arm.theta[:size], covariance=arm.covariance[:size, :size])
    return nominal_belief(arm, parameters, links=KNOWN_LINKS, held=LIGHTEST)


def _held(arm: Arm, parameters: Parameters) -> Array:
    """Return the covariance (p, p) of what a payload adds to the parameters."""
    mass = HEAVIEST * sum(body.mass for body in [*arm.model.inertias][1:])
    modes = held_modes(arm, mass)
    covariance = np.zeros((parameters.size, parameters.size))
    tool = _tool_body(arm, parameters)
    covariance[tool, tool] = modes @ modes.T
    return covariance


def _tool_body(arm: Arm, parameters: Parameters) -> slice:
    return parameters.body(int(arm.model.frames[arm.tool_frame_id].parentJoint) - 1)


def _possible(arm: Arm, body: Array, covariance: Array) -> Array:
    """Return the nearest ten parameters that a payload can have."""
    place = np.array(arm.model.frames[arm.tool_frame_id].placement.translation)
    mass = max(float(body[0]), LIGHTEST)
    ball = pin.Inertia(mass, place, 0.4 * mass * (0.1 * HELD_AT) ** 2 * np.eye(3))
    least = np.diag([1e-10 * mass, 1e-10 * mass, 1e-10 * mass, LIGHTEST])
    found = nearest(body, np.asarray(np.linalg.inv(covariance)), [least], np.zeros(10, dtype=bool))
    return pulled_inside(found, np.array(ball.toDynamicParameters()))


def _centre_covariance(body: Array, covariance: Array) -> Array:
    """Return the covariance (3, 3) of the centre `c = (first moments) / mass`, to first order."""
    slope = np.column_stack([-body[1:4] / body[0] ** 2, np.eye(3) / body[0]])
    return np.asarray(slope @ covariance[:4, :4] @ slope.T)
