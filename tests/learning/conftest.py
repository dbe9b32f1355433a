"""Arms whose plants are wrong in known ways, and runs of a law that learns them."""

from dataclasses import dataclass

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.evaluation.stress.cases import stress_scenario

DT = 1e-3


@dataclass(frozen=True)
class Run:
    """A run of the stress plant, and the controller after it."""

    controller: fp.ModelLearning
    recording: fp.Recording
    true: fp.Arm

    def error(self, start, end):
        """Largest norm of the error in a span of time [rad]."""
        t = self.recording.t
        return np.linalg.norm(self.recording.e[(start <= t) & (t < end)], axis=1).max()


@pytest.fixture(scope="session")
def panda():
    return fp.load_arm("panda")


@pytest.fixture(scope="session")
def learner(panda):
    """A controller that every test resets."""
    return fp.ModelLearning(fp.RobustFONFTSM(panda, DT), bears=(0.27, 2.5))


@pytest.fixture(scope="session")
def stressed(panda):
    """Six seconds of sinusoids on the Panda's stress plant, with the raw file as nominal arm."""
    controller = fp.ModelLearning(fp.RobustFONFTSM(panda, DT))
    scenario = stress_scenario(panda, "sine raw")
    return Run(controller, scenario.run(controller), scenario.true)
