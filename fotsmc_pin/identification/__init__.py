"""From a recorded motion to the arm that explains it: logs, identification, payload."""

from fotsmc_pin.identification.diagnosis import LogWarning
from fotsmc_pin.identification.identify import identify
from fotsmc_pin.identification.log import Log
from fotsmc_pin.identification.payload import IdentifiedPayload, identify_payload
from fotsmc_pin.identification.read_log import read_log
from fotsmc_pin.identification.result import Identification, IdentifiedParameter, TorqueCheck

__all__ = [
    "Identification",
    "IdentifiedParameter",
    "IdentifiedPayload",
    "Log",
    "LogWarning",
    "TorqueCheck",
    "identify",
    "identify_payload",
    "read_log",
]
