"""References: desired position, velocity and acceleration as functions of time.

Each is a frozen callable `t -> (q_d, v_d, a_d)` of shapes (nq,), (nv,), (nv,) that returns fresh
arrays. Any other callable of this kind will do as well.
"""

from fotsmc_pin.references.cartesian_line import CartesianLine
from fotsmc_pin.references.hold import Hold
from fotsmc_pin.references.limits import ReferenceWarning, broken_limits, warn_of_limits
from fotsmc_pin.references.minimum_jerk import MinimumJerk
from fotsmc_pin.references.path import JointPath
from fotsmc_pin.references.quintic import Quintic
from fotsmc_pin.references.sinusoid import Sinusoid
from fotsmc_pin.references.spline import Spline

__all__ = [
    "CartesianLine",
    "Hold",
    "JointPath",
    "MinimumJerk",
    "Quintic",
    "ReferenceWarning",
    "Sinusoid",
    "Spline",
    "broken_limits",
    "warn_of_limits",
]
