"""The gains of every law as keywords, for type checkers and editors.

Written by `python -m tests.control.gain_keywords` from the laws' `Gains`; do not edit it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, TypedDict

from fotsmc_pin.types import Array

PerJoint: TypeAlias = float | Sequence[float] | Array
"""One number for all joints, or one for each."""


class AdaptiveFONFTSMKeywords(TypedDict, total=False):
    """Gains of `AdaptiveFONFTSM`."""

    alpha: float
    A: PerJoint
    lam: PerJoint
    power: float
    error_floor: float
    theta: PerJoint
    mu: float
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint
    inertia: Literal["inside", "outside"]
    tempering: float
    start: Literal["caputo", "from_rest"]
    memory_horizon: float
    upsilon_0: float
    upsilon_1: float
    adaptation_rate: Literal["inverse", "direct"]
    B0_start: float
    B1_start: float
    adaptation: Literal["printed", "dead_zone", "leakage", "projection"]
    dead_zone: float
    leakage: float
    largest_bound: float


class ComputedTorqueKeywords(TypedDict, total=False):
    """Gains of `ComputedTorque`."""

    kp: PerJoint
    kd: PerJoint
    ki: PerJoint


class ContinuousTSMKeywords(TypedDict, total=False):
    """Gains of `ContinuousTSM`."""

    beta: PerJoint
    gamma: float
    K1: PerJoint
    K2: PerJoint
    rho: float


class FONFTSMKeywords(TypedDict, total=False):
    """Gains of `FONFTSM`."""

    alpha: float
    A: PerJoint
    lam: PerJoint
    power: float
    error_floor: float
    theta: PerJoint
    mu: float
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint
    inertia: Literal["inside", "outside"]
    tempering: float
    start: Literal["caputo", "from_rest"]
    memory_horizon: float
    B0: float
    B1: float


class FractionalSwitchingSMCKeywords(TypedDict, total=False):
    """Gains of `FractionalSwitchingSMC`."""

    Lambda: PerJoint
    K: PerJoint
    eta: PerJoint
    alpha: float
    tempering: float
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint


class LinearSMCKeywords(TypedDict, total=False):
    """Gains of `LinearSMC`."""

    Lambda: PerJoint
    K: PerJoint
    eta: PerJoint
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint


class NonsingularTSMKeywords(TypedDict, total=False):
    """Gains of `NonsingularTSM`."""

    beta: PerJoint
    gamma: float
    K: PerJoint
    eta: PerJoint
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint


class RobustFONFTSMKeywords(TypedDict, total=False):
    """Gains of `RobustFONFTSM`."""

    bandwidth: float
    alpha: float
    tempering: float
    A: PerJoint
    lam: PerJoint
    power: float
    reach: PerJoint | None
    approach: PerJoint | None
    approach_rate: PerJoint
    theta: PerJoint
    mu: float
    integral: PerJoint
    boundary_layer: PerJoint
    observer: PerJoint
    rotor_limit: PerJoint | None
    rotor_doubt: PerJoint | None
    floor_share: PerJoint
    floor_rate: PerJoint
    floor_limit: PerJoint | None
    anti_windup: bool
    memory_horizon: float


class SuperTwistingSMCKeywords(TypedDict, total=False):
    """Gains of `SuperTwistingSMC`."""

    Lambda: PerJoint
    k1: PerJoint
    k2: PerJoint
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint


class TDEFONTSMKeywords(TypedDict, total=False):
    """Gains of `TDEFONTSM`."""

    inertia: PerJoint | None
    Lambda: PerJoint
    k: PerJoint
    power: float
    alpha: float
    K1: PerJoint
    K2: PerJoint
    rho: float
    filter_rate: float


class TerminalSMCKeywords(TypedDict, total=False):
    """Gains of `TerminalSMC`."""

    beta: PerJoint
    power: float
    error_floor: float
    K: PerJoint
    eta: PerJoint
    switching: Literal["sign", "saturation", "tanh", "power"]
    boundary_layer: PerJoint
