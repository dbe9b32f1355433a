from .cartesian_line import CartesianLine as CartesianLine
from .excitation import Excitation as Excitation
from .hold import Hold as Hold
from .limits import (
    ReferenceWarning as ReferenceWarning,
    broken_limits as broken_limits,
    warn_of_limits as warn_of_limits,
)
from .live_target import LiveTarget as LiveTarget
from .minimum_jerk import MinimumJerk as MinimumJerk
from .path import JointPath as JointPath
from .quintic import Quintic as Quintic
from .sinusoid import Sinusoid as Sinusoid
from .spline import Spline as Spline
from .poses import (
    PoseArc as PoseArc,
    PoseHold as PoseHold,
    PoseLine as PoseLine,
    PoseMotion as PoseMotion,
    PoseOfJoints as PoseOfJoints,
    PosePath as PosePath,
    PoseScrew as PoseScrew,
    PoseSwing as PoseSwing,
    PoseWaypoints as PoseWaypoints,
)
