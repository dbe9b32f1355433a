"""What a control law of one's own is written with, in one import."""

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows, Streams
from fotsmc_pin.control.functions import clip, norm, sig, switch
from fotsmc_pin.control.gains import DERIVED, Gains, codes, flag, option, per_joint, scalar
from fotsmc_pin.control.rows import Joints, NoRows, named_rows, rows
from fotsmc_pin.control.torque_limits import integrated, inverse_dynamics, unwound
from fotsmc_pin.fractional.advance import advance, commit, predict
from fotsmc_pin.types import Array

__all__ = [
    "Array",
    "Controller",
    "DERIVED",
    "Gains",
    "Joints",
    "NoRows",
    "SignalRows",
    "Streams",
    "advance",
    "clip",
    "codes",
    "commit",
    "flag",
    "integrated",
    "inverse_dynamics",
    "kernel",
    "named_rows",
    "norm",
    "option",
    "per_joint",
    "predict",
    "rows",
    "scalar",
    "sig",
    "switch",
    "unwound",
]
