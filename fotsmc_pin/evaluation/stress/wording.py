"""What a case does to an arm, in words and with the arm's own numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.evaluation.stress.plants import (
    SPRING_DAMPING,
    joint_friction,
    true_armature,
)
from fotsmc_pin.evaluation.stress.scenario import POSITION_NOISE, START_ERROR, VELOCITY_NOISE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.evaluation.stress.case import Case


def plant_text(case: Case, nominal: Arm, bare: Arm, payload: float) -> str:
    """Return the plant of a case in sentences; lists are in the order of the joints.

    Args:
        case: the case.
        nominal: the nominal arm.
        bare: the arm by rule, without a tool, from which the true one is made.
        payload: mass of the tool [kg].
    """
    return " ".join(
        part
        for part in (
            _masses(case, payload),
            _rotors(case, nominal, bare),
            _friction(case, bare),
            _springs(case, bare),
            _loop(case),
        )
        if part
    )


def _masses(case: Case, payload: float) -> str:
    links = "as heavy as" if case.mass_scale == 1.0 else f"{case.mass_scale:g} times as heavy as"
    tool = (
        f"{payload:.3g} kg at its tool that the nominal arm lacks"
        if case.tool == "true"
        else f"no tool where the nominal arm has one of {payload:.3g} kg"
    )
    return f"The true arm's links are {links} the nominal arm's; it has {tool}."


def _rotors(case: Case, nominal: Arm, bare: Arm) -> str:
    if case.rotors is None:
        return f"Armature of both arms as in the file: {_list(nominal.armature)} kg·m²."
    guessed = ""
    if not np.isfinite(bare.effort_limit).all():
        guessed = (
            f" Where no limit is stated, drives are taken to be for {_list(drive_size(bare))} N·m."
        )
    source = "by rule, limit / 200" if case.known_rotors else "as in the file"
    return (
        f"True armature limit / {case.rotors:g}: {_list(true_armature(bare, case.rotors))} kg·m²; "
        f"nominal armature {source}: {_list(nominal.armature)} kg·m².{guessed}"
    )


def _friction(case: Case, nominal: Arm) -> str:
    rubbing = f"Coulomb and viscous friction {_list(joint_friction(nominal))} N·m and N·m·s/rad"
    if case.stiction is None:
        return f"{rubbing}."
    return (
        f"{rubbing}; breakaway at {case.stiction:g} times the former, falling over "
        f"{case.stribeck_velocity:g} rad/s."
    )


def _springs(case: Case, nominal: Arm) -> str:
    if case.stiffness is None:
        return ""
    springs = case.stiffness * drive_size(nominal)
    return (
        f"Joint stiffness limit × {case.stiffness:g}/rad: {_list(springs)} N·m/rad, damping ratio "
        f"{SPRING_DAMPING:g} of the motor on it; encoders on the {case.encoder} side; around the "
        "law is a SpringObserver that knows the stiffness and the nominal rotors."
    )


def _loop(case: Case) -> str:
    measured = (
        f"noise of {POSITION_NOISE:g} rad and {VELOCITY_NOISE:g} rad/s"
        if case.bits is None
        else f"encoders of {case.bits} bits in a turn, velocity from a differentiator of 300 rad/s"
    )
    ticks = "one tick" if case.delay == 1 else f"{case.delay} ticks"
    return (
        f"Ticks of {1e3 * case.dt:g} ms, torque {ticks} late, {measured}; every joint starts "
        f"{START_ERROR:g} rad off."
    )


def _list(values: Iterable[float]) -> str:
    numbers = [f"{value:.3g}" for value in values]
    return numbers[0] if len(set(numbers)) == 1 else f"({', '.join(numbers)})"
