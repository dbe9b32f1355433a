"""The page about learning states the numbers that the estimator has."""

from __future__ import annotations

from pathlib import Path

import pytest

import fotsmc_pin as fp
from fotsmc_pin.learning import estimator, model_learning, parameters, trust

PAGE = Path(__file__).parents[2] / "docs/learning.md"
TEXT = " ".join(PAGE.read_text("utf-8").split())
WORDS = {1.0: "a second", 2.0: "two", 4: "four", 1e-4: "a ten-thousandth", 9.0: "nine", 0.5: "half"}
TICK = 1e-3


@pytest.mark.parametrize(
    "said",
    [
        f"Over a window of {WORDS[estimator.WINDOW]} ticks",
        f"smoothed over {estimator.SIGN_WIDTH:g} rad/s",
        f"{WORDS[estimator.REPEATS]} low-passes of {estimator.RATE:g} rad/s in series",
        rf"\(\kappa = {estimator.REPEATS:g}/({estimator.RATE:g}\,\mathrm{{rad/s}}\cdot T)\) times, "
        f"{estimator.REPEATS / (estimator.RATE * estimator.WINDOW * TICK):g} at 1 kHz",
        f"averaged over {WORDS[1.0 / estimator.NOISE_RATE]}",
        f"{WORDS[estimator.STICKING]} of what its friction may be, "
        rf"\(\sqrt{{\hat f^2 + ({estimator.DOUBTED:g}\,\sigma_f)^2}}\), is added",
        f"gains {WORDS[estimator.DRIFT]} of its first variance per second",
        f"slower than about {estimator.STILL:g} rad/s for {WORDS[estimator.IDLE]} of the recent",
        f"is more than {WORDS[estimator.SURPRISING]} times",
        f"fade into the law's model over {trust.FADING:g} s",
        rf"\((\hat\theta - {trust.SURE:g}\sigma)/m_\mathrm{{low}}\)",
        f"at most {trust.FARTHEST_LINK:g} m from the nominal one",
        f"at most {trust.FARTHEST:g} m from the tool",
        f"within {trust.TURNING:g} rad of the wanted way",
        f"it is taken back in {trust.RELIEF:g} s",
        f"| centre of mass of a link | {parameters.CENTRES:g} m along each axis |",
        f"| factor on a link | {parameters.LINKS:g} |",
        f"| payload | {parameters.PAYLOAD:g} of the mass of all moving links, its centre within "
        f"{parameters.OFFSET:g} m of the tool frame |",
        f"effort limit / {parameters.LIMIT_OVER_ARMATURE:g} |",
        f"{parameters.FRICTION:g} N·m, {parameters.FRICTION:g} N·m·s/rad; in proportion less "
        f"where the effort limit is below {parameters.FULL_EFFORT:g} N·m",
        f"{WORDS[1.0 / model_learning.SAFETY].capitalize()} of that range on either side",
    ],
)
def test_the_page_states_a_number_of_the_estimator(said):
    assert said in TEXT


def test_the_page_counts_the_parameters_of_a_panda():
    count = len(fp.ModelLearning(fp.ComputedTorque(fp.load_arm("panda"), 1e-3)).estimates())
    assert f"{count} for seven joints" in TEXT


def test_the_page_names_every_signal():
    law = fp.ComputedTorque(fp.load_arm("two_link"), 1e-3)
    own = fp.ModelLearning(law).signals.keys() - law.signals.keys()
    for name in own - {f"{name}_deviation" for name in own}:
        assert f"`{name}`" in TEXT
