"""From a recorded motion to the arm that explains it: logs, identification, payload."""

from fotsmc_pin.identification.log import Log
from fotsmc_pin.identification.read_log import LogWarning, read_log

__all__ = ["Log", "LogWarning", "read_log"]
