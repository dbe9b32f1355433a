"""Control laws: one file each, all with the face of `Controller`."""

from fotsmc_pin.control.adaptive_fonftsm import AdaptiveFONFTSM
from fotsmc_pin.control.controller import Controller
from fotsmc_pin.control.fonftsm import FONFTSM, PaperConditionWarning

CONTROLLERS: dict[str, type[Controller]] = {law.__name__: law for law in (AdaptiveFONFTSM, FONFTSM)}
"""Every law by name: what the tables, the laws of behaviour and the command line run over."""

__all__ = ["CONTROLLERS", "FONFTSM", "AdaptiveFONFTSM", "Controller", "PaperConditionWarning"]
