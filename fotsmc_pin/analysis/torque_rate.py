"""The torque rate that encoders' steps ask of a law, and whether a safeguard allows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.control import FilteredDifferentiator
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.user_warnings import warn_user

if TYPE_CHECKING:
    from fotsmc_pin.control import Controller, Safeguard
    from fotsmc_pin.simulation import Encoder
    from fotsmc_pin.types import Array

RATES = 512
"""Frequencies over which noise is summed."""
AMPLITUDE = 1e-4
"""Error at which slopes are taken [rad, m]."""
ENOUGH = 2.0
"""Allowed rate over the RMS of what is asked from which on a loop keeps its accuracy."""


class TorqueRateWarning(UserWarning):
    """A limit of the torque's rate is lower than what a loop's noise asks for."""


def asked_torque_rate(controller: Controller, encoder: Encoder) -> Array:
    """Return the RMS rate of torque that an encoder's steps ask of a law, (nv,) [N·m/s, N/s].

    A reading on steps of the size `s` is noise of `s / √12`. It passes the differentiator and the
    law, `u = L_e e + L_v ė` with the law's linear system near its surface, and the mass matrix at
    the neutral configuration:

        rate² = M0² · (s²/12) · mean over ω of |(1 - e^{-jω dt}) (L_e + L_v F)|² / dt².

    The motion's own rate comes on top. What the loop answers is left out, as it is slower than
    what counts here.

    Args:
        controller: the law; it is left as it was.
        encoder: what measures, with a `FilteredDifferentiator`.

    Raises:
        ArgumentError: another differentiator, or a law that is none near its surface; see
            `margins`.
    """
    differentiator = encoder.differentiator
    if not isinstance(differentiator, FilteredDifferentiator):
        remedy = "give it a FilteredDifferentiator; what another one does to noise is not linear"
        raise ArgumentError("encoder", type(differentiator).__name__, remedy)
    dt, arm = controller.dt, controller.arm
    z = np.exp(1j * np.pi * (np.arange(RATES) + 0.5) / RATES)
    share = -np.expm1(-differentiator.bandwidth * dt)
    velocity = share * (1.0 - 1.0 / z) / dt / (1.0 - (1.0 - share) / z)
    gains = []
    for law in linearize(controller, AMPLITUDE):
        inside = z[:, None, None] * np.eye(len(law.A)) - law.A
        response = np.linalg.solve(inside, np.broadcast_to(law.B, (RATES, *law.B.shape)))
        slopes = law.C @ response + law.D
        change = (1.0 - 1.0 / z) * (slopes[:, 0] + slopes[:, 1] * velocity)
        gains.append(np.sqrt(np.mean(np.abs(change) ** 2)) / dt)
    noise = encoder.step / np.sqrt(12.0)
    M0 = arm.mass_matrix(arm.neutral)
    asked: Array = np.sqrt(M0**2 @ (np.array(gains) * noise) ** 2)
    return asked


def warn_of_torque_rate(guard: Safeguard, encoder: Encoder) -> None:
    """Warn before a run where a safeguard's `torque_rate` is lower than an encoder's steps ask for.

    Silent without such a limit, and for laws and encoders of which `asked_torque_rate` cannot tell.

    Args:
        guard: the safeguard, around a law.
        encoder: what measures.

    Warns:
        TorqueRateWarning: the limit is less than twice the RMS of what is asked; it names the joint
            and both numbers.
    """
    allowed = guard.torque_rate
    if np.isinf(allowed).all():
        return
    try:
        asked = asked_torque_rate(guard.controller, encoder)
    except (ArgumentError, AttributeError, TypeError):  # a law of another form
        return
    j = int(np.argmax(asked / allowed))
    if allowed[j] < ENOUGH * asked[j]:
        arm = guard.arm
        unit = f"{arm.effort_units[j]}/s"
        warn_user(
            f"torque_rate = {allowed[j]:.0f} {unit} is less than twice what the encoder's steps "
            f"ask of {arm.joint_names[j]}, {asked[j]:.0f} {unit} RMS: the loop loses accuracy, "
            "and then the arm; allow more, take finer encoders or a lower `bandwidth` of their "
            "differentiator or of the law",
            TorqueRateWarning,
        )
