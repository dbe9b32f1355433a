"""Gains as data: every one is described, checked, and shown; so is every signal."""

from dataclasses import fields

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.control import CONTROLLERS, FONFTSM, AdaptiveFONFTSM, LinearSMC, RobustFONFTSM
from fotsmc_pin.errors import ArgumentError
from tests.control import gain_keywords

LAWS = list(CONTROLLERS.values())
QUIET = {FONFTSM: {"power": 1.1}, AdaptiveFONFTSM: {"power": 1.1}}
EVERY_LAW = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)


@EVERY_LAW
def test_every_preset_names_gains_that_exist(law):
    known = {field.name for field in fields(law.Gains)}
    assert law.presets
    for changes in law.presets.values():
        assert set(changes) <= known


@EVERY_LAW
def test_every_law_says_where_it_comes_from(law):
    assert "Source:" in law.__doc__ or law.representative
    assert law.representative == ("representative" in law.__doc__.lower())


def test_every_signal_is_described(case, arms, make):
    law, preset = case
    described = "\n".join(cls.__doc__ or "" for cls in law.__mro__)
    for name in make(law, arms["two_link"], preset).signals:
        assert f'"{name}"' in described


@pytest.fixture(scope="module")
def two_link():
    return load_arm("two_link")


def test_an_unknown_gain_is_named_with_its_nearest_kin(two_link):
    with pytest.raises(ArgumentError, match=r"Lambd = .*did you mean Lambda.*boundary_layer"):
        LinearSMC(two_link, 1e-3, Lambd=1.0)


@pytest.mark.parametrize(
    ("gain", "value"),
    [
        ("A", 0.0),
        ("A", [1.0, 2.0, 3.0]),
        ("A", [1.0, np.nan]),
        ("alpha", 1.0),
        ("alpha", -0.1),
        ("alpha", "half"),
        ("mu", 1.0),
        ("switching", "signum"),
        ("inertia", None),
        ("boundary_layer", -1.0),
        ("B0", None),
    ],
)
def test_a_gain_out_of_its_range_is_refused(two_link, gain, value):
    with pytest.raises(ArgumentError) as caught:
        FONFTSM(two_link, 1e-3, preset="practical", **{gain: value})
    assert caught.value.argument == gain


def test_an_unknown_preset_is_refused(two_link):
    with pytest.raises(ArgumentError, match="paper, practical"):
        AdaptiveFONFTSM(two_link, 1e-3, preset="best")


@pytest.mark.parametrize("dt", [0.0, -1.0, np.inf, "1 ms"])
def test_an_unusable_tick_is_refused(two_link, dt):
    with pytest.raises(ArgumentError, match="dt"):
        LinearSMC(two_link, dt)


def test_single_gains_stand_over_the_preset(two_link):
    controller = FONFTSM(two_link, 1e-3, preset="practical", A=[3.0, 4.0])
    np.testing.assert_array_equal(controller.gains.A, [3.0, 4.0])
    assert controller.gains.theta.tolist() == [10.0, 10.0]
    shown = controller.gains.as_dict()
    assert shown["A"] == [3.0, 4.0]
    assert shown["theta"] == 10.0
    assert shown["switching"] == "tanh"


def test_gains_in_force_make_the_same_controller_again(case, arms, make, wander):
    law, preset = case
    arm = arms["kinova"]
    first = make(law, arm, preset)
    second = make(law, arm, **first.gains.as_dict())
    for row in wander(arm, 10):
        np.testing.assert_array_equal(first.update(*row), second.update(*row))


@EVERY_LAW
def test_gains_made_directly_are_checked(law, arms):
    """Every number refuses what is not finite, every word what is not among its choices."""
    good = law(arms["two_link"], 1e-3, **QUIET.get(law, {})).gains
    values = {field.name: getattr(good, field.name) for field in fields(good)}
    assert type(good)(**values).as_dict() == good.as_dict()
    for field in fields(good):
        bad = "nonsense" if field.metadata["kind"] in ("option", "flag") else np.nan
        with pytest.raises(ArgumentError) as caught:
            type(good)(**values | {field.name: bad})
        assert caught.value.argument == field.name


def test_a_gain_that_the_controller_derives_is_asked_for():
    with pytest.raises(ArgumentError, match="a controller derives it"):
        RobustFONFTSM.Gains()


def test_a_gain_per_joint_is_an_array_also_when_it_is_made_directly():
    gains = LinearSMC.Gains(K=[1.0, 2.0, 3.0])
    assert gains.K.tolist() == [1.0, 2.0, 3.0]
    assert gains.eta.tolist() == [5.0]


def test_a_limit_may_be_infinite_and_a_rate_may_not(two_link):
    law = RobustFONFTSM(two_link, 1e-3, floor_limit=np.inf)
    assert np.isinf(law.gains.floor_limit).all()
    with pytest.raises(ArgumentError, match="theta"):
        RobustFONFTSM(two_link, 1e-3, theta=np.inf)


def test_the_keywords_that_editors_see_are_the_gains():
    """To mend it: python -m tests.control.gain_keywords."""
    assert gain_keywords.FILE.read_text("utf-8") == gain_keywords.written()
