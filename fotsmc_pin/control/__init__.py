"""Control laws: one file each, all with the face of `Controller`."""

from typing import Any

from fotsmc_pin.control.adaptive_fonftsm import AdaptiveFONFTSM
from fotsmc_pin.control.computed_torque import ComputedTorque
from fotsmc_pin.control.conditions import (
    GravityWarning,
    PaperConditionWarning,
    TickWarning,
    warn_of_gravity,
)
from fotsmc_pin.control.continuous_tsm import ContinuousTSM
from fotsmc_pin.control.controller import Controller
from fotsmc_pin.control.differentiator import ExactDifferentiator, FilteredDifferentiator
from fotsmc_pin.control.fonftsm import FONFTSM
from fotsmc_pin.control.fractional_switching_smc import FractionalSwitchingSMC
from fotsmc_pin.control.friction_compensation import FrictionCompensation
from fotsmc_pin.control.friction_terms import FrictionTerms
from fotsmc_pin.control.linear_smc import LinearSMC
from fotsmc_pin.control.nonsingular_tsm import NonsingularTSM
from fotsmc_pin.control.robust_fonftsm import RobustFONFTSM
from fotsmc_pin.control.safety import Limits, Safeguard, SoftStart
from fotsmc_pin.control.spring_observer import SpringObserver
from fotsmc_pin.control.super_twisting_smc import SuperTwistingSMC
from fotsmc_pin.control.task_space import CartesianImpedance, TaskSpace
from fotsmc_pin.control.tde_fontsm import TDEFONTSM
from fotsmc_pin.control.terminal_smc import TerminalSMC

_LAWS: tuple[type[Controller[Any]], ...] = (
    RobustFONFTSM,
    AdaptiveFONFTSM,
    FONFTSM,
    ContinuousTSM,
    SuperTwistingSMC,
    TDEFONTSM,
    FractionalSwitchingSMC,
    LinearSMC,
    TerminalSMC,
    NonsingularTSM,
    ComputedTorque,
)

CONTROLLERS: dict[str, type[Controller[Any]]] = {law.__name__: law for law in _LAWS}
"""Every law by name: what the tables, the laws of behaviour and the command line run over."""

__all__ = [
    "CONTROLLERS",
    "FONFTSM",
    "TDEFONTSM",
    "AdaptiveFONFTSM",
    "CartesianImpedance",
    "ComputedTorque",
    "ContinuousTSM",
    "Controller",
    "ExactDifferentiator",
    "FilteredDifferentiator",
    "FractionalSwitchingSMC",
    "FrictionCompensation",
    "FrictionTerms",
    "GravityWarning",
    "Limits",
    "LinearSMC",
    "NonsingularTSM",
    "PaperConditionWarning",
    "RobustFONFTSM",
    "Safeguard",
    "SoftStart",
    "SpringObserver",
    "SuperTwistingSMC",
    "TaskSpace",
    "TerminalSMC",
    "TickWarning",
    "warn_of_gravity",
]
