"""What stands between any controller and real drives."""

from fotsmc_pin.control.safety.drives import Drives
from fotsmc_pin.control.safety.limits import Limits
from fotsmc_pin.control.safety.safeguard import Safeguard
from fotsmc_pin.control.safety.soft_start import SoftStart

__all__ = ["Drives", "Limits", "Safeguard", "SoftStart"]
