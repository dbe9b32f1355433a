"""Arguments of the wrong kind get the library's own errors, at every public door."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import CartesianLine, broken_limits

ARM = fp.load_arm("two_link")
HOLD = fp.references.Hold(ARM)
LAW = fp.ComputedTorque(ARM, 1e-3)
ROWS = np.zeros((4, 2))
T = [0.0, 1.0, 2.0, 3.0]

CALLS = {
    **{name: lambda law=law: law("panda", 1e-3) for name, law in CONTROLLERS.items()},
    "Hold": lambda: fp.references.Hold(np.zeros(2)),
    "Sinusoid": lambda: fp.references.Sinusoid(
        arm="two_link", center=np.zeros(2), amplitude=np.ones(2), period=1.0
    ),
    "Sinusoid.inside_limits": lambda: fp.references.Sinusoid.inside_limits("two_link"),
    "Quintic.through": lambda: fp.references.Quintic.through("two_link", ROWS),
    "MinimumJerk.through": lambda: fp.references.MinimumJerk.through(ROWS, ROWS),
    "Spline.from_samples": lambda: fp.references.Spline.from_samples(None, T, ROWS),
    "Spline.from_csv": lambda: fp.references.Spline.from_csv("two_link", "no.csv"),
    "CartesianLine.along": lambda: CartesianLine.along("two_link", [0.1, 0.0, 0.0]),
    "broken_limits": lambda: broken_limits("two_link", HOLD, duration=1.0),
    "perturb": lambda: fp.perturb("two_link", mass_scale=1.1),
    "inspect_arm": lambda: fp.inspect_arm("two_link"),
    "simulate, arm": lambda: fp.simulate("two_link", LAW, HOLD, 1.0),
    "simulate, controller": lambda: fp.simulate(ARM, "RobustFONFTSM", HOLD, 1.0),
    "simulate, law": lambda: fp.simulate(ARM, fp.RobustFONFTSM, HOLD, 1.0),
    "simulate, reference": lambda: fp.simulate(ARM, LAW, np.zeros(2), 1.0),
    "simulate, disturbance": lambda: fp.simulate(ARM, LAW, HOLD, 1.0, disturbance=3.0),
    "simulate, events": lambda: fp.simulate(ARM, LAW, HOLD, 1.0, events=[ARM]),
    "Wrench": lambda: fp.Wrench(start="now", duration=1.0),
    "summarize": lambda: fp.summarize("run.npz"),
    "ClosedLoop": lambda: fp.ClosedLoop(arm=3),
    "study": lambda: fp.study("two_link"),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_a_wrong_kind_is_an_argument_error_with_a_remedy(call):
    with pytest.raises(ArgumentError, match="give "):
        call()
