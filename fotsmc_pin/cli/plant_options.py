"""The options about the true arm, the same on every command that makes one from a nominal arm."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.values import VALUE, number, values_by_name
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm, Payload

PANEL = "How the true arm differs"


def _option(help_text: str, metavar: str = "VALUE") -> Any:
    return typer.Option(help=help_text, rich_help_panel=PANEL, metavar=metavar)


@dataclass(frozen=True, kw_only=True)
class PlantOptions:
    """What `perturb` does to an arm, as typed; `apply` does it."""

    mass_scale: Annotated[
        list[str] | None, _option(f"Factor on mass and inertia of links: {VALUE}.")
    ] = None
    inertia_scale: Annotated[
        list[str] | None, _option(f"Factor on rotational inertia of links: {VALUE}.")
    ] = None
    com_shift: Annotated[
        list[str] | None,
        _option(f"Shift of centres of mass in a random direction [m]: {VALUE}. Needs --seed."),
    ] = None
    payload: Annotated[
        str, _option("Mass at the true tool frame [kg]: number, or low:high to draw.")
    ] = "0"
    payload_frame: Annotated[
        str | None, _option("Link that carries the payload; the tool frame by default.", "LINK")
    ] = None
    friction: Annotated[
        list[str] | None, _option(f"Coulomb friction of joints [N·m, N]: {VALUE}.")
    ] = None
    damping: Annotated[
        list[str] | None, _option(f"Viscous friction of joints [N·m·s/rad, N·s/m]: {VALUE}.")
    ] = None
    true_armature: Annotated[
        list[str] | None, _option(f"Rotor inertia of the true joints [kg·m², kg]: {VALUE}.")
    ] = None
    stiction: Annotated[
        list[str] | None,
        _option(f"Breakaway over Coulomb friction, a ratio of at least 1: {VALUE}."),
    ] = None
    stribeck_velocity: Annotated[
        list[str] | None,
        _option(f"Speed by which friction falls to Coulomb's [rad/s, m/s]: {VALUE}."),
    ] = None
    joint_stiffness: Annotated[
        list[str] | None, _option(f"Stiffness of elastic joints [N·m/rad, N/m]: {VALUE}.")
    ] = None
    joint_damping: Annotated[
        list[str] | None, _option(f"Damping of elastic joints [N·m·s/rad, N·s/m]: {VALUE}.")
    ] = None
    seed: Annotated[
        int | None, typer.Option(help="Where all random numbers come from; needed for draws.")
    ] = None

    @property
    def asks_for_changes(self) -> bool:
        """Whether anything but the seed was given."""
        return any(getattr(self, f.name) != f.default for f in fields(self) if f.name != "seed")

    def _held(self) -> Payload | None:
        from fotsmc_pin.arms import Payload

        kilograms = number("--payload", self.payload)
        try:
            return Payload(mass=kilograms, frame=self.payload_frame) if kilograms else None
        except ArgumentError as error:
            raise ArgumentError("--payload", self.payload, error.remedy) from None

    def apply(self, arm: Arm) -> Arm:
        """Return the arm with all of this done to it.

        Raises:
            ArgumentError: an option cannot be used.
        """
        from fotsmc_pin.arms import perturb

        given: dict[str, Any] = {
            "mass_scale": values_by_name("--mass-scale", self.mass_scale, None),
            "inertia_scale": values_by_name("--inertia-scale", self.inertia_scale, None),
            "com_shift": values_by_name("--com-shift", self.com_shift, None),
            "payload": self._held(),
            "friction": values_by_name("--friction", self.friction, None),
            "damping": values_by_name("--damping", self.damping, None),
            "armature": values_by_name("--true-armature", self.true_armature, None),
            "stiction": values_by_name("--stiction", self.stiction, None),
            "stribeck_velocity": values_by_name(
                "--stribeck-velocity", self.stribeck_velocity, None
            ),
            "joint_stiffness": values_by_name("--joint-stiffness", self.joint_stiffness, None),
            "joint_damping": values_by_name("--joint-damping", self.joint_damping, None),
        }
        changes = {name: value for name, value in given.items() if value is not None}
        return perturb(arm, seed=self.seed, **changes)
