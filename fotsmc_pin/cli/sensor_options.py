"""The options about what is measured in a run, on the arm of `fotsmc simulate`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Sensor

PANEL = "What is measured"
VELOCITY_NOISE = 100.0
"""Noise of the measured speed over that of the measured position [1/s]."""


@dataclass(frozen=True, kw_only=True)
class SensorOptions:
    """Sensors as typed; `make` makes them."""

    noise: Annotated[
        float,
        typer.Option(
            help="Standard deviation of the measured positions [rad, m]; speeds get 100 times as "
            "much per second [rad/s, m/s].",
            rich_help_panel=PANEL,
        ),
    ] = 0.0
    encoder_bits: Annotated[
        int | None,
        typer.Option(
            help="Bits of the encoders in a turn of a joint; speeds then come from positions.",
            rich_help_panel=PANEL,
        ),
    ] = None
    torque_noise: Annotated[
        float | None,
        typer.Option(
            help="Measure torque, with this standard deviation as a share of each joint's effort "
            "limit: 0.005; 0 measures it exactly. It is kept in run.npz as tau_measured.",
            rich_help_panel=PANEL,
        ),
    ] = None
    torque_step: Annotated[
        float | None,
        typer.Option(
            help="Measure torque in steps of this share of each effort limit: 0.001.",
            rich_help_panel=PANEL,
        ),
    ] = None

    def make(self, arm: Arm, dt: float, seed: int | None) -> Sensor | None:
        """Return what stands between the true arm and the controller, None for nothing.

        Raises:
            ArgumentError: an option cannot be used.
        """
        import numpy as np

        from fotsmc_pin.simulation import Chain, Encoder, NoisySensor, TorqueSensor

        parts: list[Sensor] = []
        if self.noise != 0.0:
            noise = _at_least_zero("--noise", self.noise)
            speed = VELOCITY_NOISE * noise
            parts.append(NoisySensor(arm, position=noise, velocity=speed, seed=seed or 0))
        if self.encoder_bits is not None:
            if self.encoder_bits < 1:
                raise ArgumentError("--encoder-bits", self.encoder_bits, "give at least 1")
            parts.append(Encoder(arm, dt, bits=self.encoder_bits))
        if self.torque_noise is not None or self.torque_step is not None:
            noise = _at_least_zero("--torque-noise", self.torque_noise or 0.0)
            step = _at_least_zero("--torque-step", self.torque_step or 0.0)
            limit = arm.effort_limit
            if (noise or step) and not np.isfinite(limit).all():
                joint = arm.joint_names[int(np.argmax(~np.isfinite(limit)))]
                option, value = ("--torque-noise", noise) if noise else ("--torque-step", step)
                raise ArgumentError(
                    option, value, f"is a share of effort limits, and {joint} has none"
                )
            full = np.where(np.isfinite(limit), limit, 0.0)
            parts.append(TorqueSensor(arm, noise=noise * full, step=step * full, seed=seed or 0))
        return Chain(*parts) if len(parts) > 1 else (parts[0] if parts else None)


def _at_least_zero(option: str, value: float) -> float:
    if not (value >= 0.0 and math.isfinite(value)):
        raise ArgumentError(option, value, "give a number of at least 0")
    return value
