"""Learning an arm while it moves: what its file has wrong, estimated from ordinary motion.

`ModelLearning` wraps a controller. `Prior` says what is believed beforehand, `Estimates` what is
known afterwards.
"""

from fotsmc_pin.learning.described import recorded_estimates
from fotsmc_pin.learning.estimates import Estimate, Estimates
from fotsmc_pin.learning.model_learning import ModelLearning
from fotsmc_pin.learning.parameters import Prior

__all__ = ["Estimate", "Estimates", "ModelLearning", "Prior", "recorded_estimates"]
