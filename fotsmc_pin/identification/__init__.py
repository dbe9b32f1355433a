"""From a recorded motion to the arm that explains it: logs, identification, payload."""

from fotsmc_pin.identification.log import Log

__all__ = ["Log"]
