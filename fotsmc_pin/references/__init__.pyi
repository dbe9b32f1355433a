from .cartesian_line import CartesianLine as CartesianLine
from .hold import Hold as Hold
from .limits import broken_limits as broken_limits
from .minimum_jerk import MinimumJerk as MinimumJerk
from .path import JointPath as JointPath
from .quintic import Quintic as Quintic
from .sinusoid import Sinusoid as Sinusoid
from .spline import Spline as Spline
