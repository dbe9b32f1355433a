"""The torque of every law in C is that of Python, and so are the errors."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import with_known_friction
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.errors import ArgumentError

from .compiled_c import STRICT, compile_shared, terms
from .conftest import ARMS, CASES, DT, arm_named, make, rough_run, worst

EXACT = 1e-12
NAMES = [f"{law.__name__}-{preset}" for law, preset in CASES]


def arm_of(place):
    return arm_named(ARMS[place % len(ARMS)])


@pytest.mark.parametrize("place", range(len(CASES)), ids=NAMES)
def test_the_torque_is_pythons(place, compiled):
    law, preset = CASES[place]
    controller = make(law, arm_of(place), preset)
    inputs = rough_run(controller)
    c = compiled(controller, flags=STRICT)
    tau, status = c.replay(inputs)
    assert not status.any()
    assert worst(tau, inputs) < EXACT
    assert np.abs(np.diff(tau, axis=0)).max() > 0.0
    c.reset()
    again, _ = c.replay(inputs)
    assert again.tobytes() == tau.tobytes()


@pytest.mark.parametrize("name", ["AdaptiveFONFTSM", "RobustFONFTSM", "ComputedTorque"])
def test_gains_may_be_changed_while_it_runs(name, compiled):
    law, arm = CONTROLLERS[name], arm_named("two_link")
    gain = "kp" if name == "ComputedTorque" else "theta"
    weak = make(law, arm)
    strong = make(law, arm, **{gain: 2.0 * getattr(weak.gains, gain)})
    inputs = rough_run(strong)
    c = compiled(weak)
    before, _ = c.replay(inputs)
    assert worst(before, inputs) > 1e-3
    c.init()
    place = [line.split()[1].split("[")[0] for line in _gains(c) if line.startswith("    double")]
    sizes = [2 if "[2]" in line else 1 for line in _gains(c) if line.startswith("    double")]
    start = sum(sizes[: place.index(gain)])
    values = np.frombuffer(c.state, np.float64, sum(sizes))
    values[start : start + 2] = getattr(strong.effective_gains(), gain)
    after, _ = c.replay(inputs)
    assert worst(after, inputs) < EXACT


def _gains(c):
    text = c.header.read_text("utf-8")
    return text.split(" nothing checks them", 1)[-1].split("typedef struct {")[1].splitlines()


@pytest.mark.parametrize("name", ["AdaptiveFONFTSM", "RobustFONFTSM", "LinearSMC", "TDEFONTSM"])
def test_single_precision_is_near(name, compiled):
    law = CONTROLLERS[name]
    controller = make(law, arm_named("panda"), [*law.presets][-1])
    inputs = rough_run(controller)
    tau, status = compiled(controller, single=True).replay(inputs)
    assert not status.any()
    largest = np.abs(inputs.tau).max(axis=0)
    assert (np.abs(tau - inputs.tau) / largest).max() < 1e-4


def test_a_bad_argument_leaves_the_state_as_it_was(compiled):
    arm = arm_named("kinova")
    controller = make(CONTROLLERS["RobustFONFTSM"], arm)
    c = compiled(controller)
    good = [np.array(x) for x in (arm.neutral, np.zeros(arm.nv))]
    good = [good[0], good[1], good[0], good[1], good[1]]
    names = ("q", "v", "q_d", "v_d", "a_d")
    model = terms(arm, controller, good[0], good[1])
    first, status = c.update(*good, *model, DT)
    controller.update(*good)
    assert status == 0
    for code, name in enumerate(names, 1):
        for value in (np.nan, np.inf, -np.inf):
            bad = [x.copy() for x in good]
            bad[code - 1][-1] = value
            before = bytes(c.state)
            tau, status = c.update(*bad, *model, DT)
            assert (status, bytes(c.state)) == (code, before)
            assert np.array_equal(tau, first)
            with pytest.raises(ArgumentError) as error:
                controller.update(*bad)
            assert error.value.argument == name
    wide = [x.copy() for x in good]
    wide[0][:2] *= 1.1
    assert c.update(*wide, *model, DT)[1] == 1
    for dt in (np.nan, np.inf, 0.0, -DT, 1e-7, 2e3):
        assert c.update(*good, *model, dt)[1] == 6
        with pytest.raises(ArgumentError, match="dt"):
            controller.update(*good, dt=dt)
    for bad in (np.full_like(model[0], np.nan), model[0] + 1e9):
        assert c.update(*good, bad, *model[1:], DT)[1] == 7


def test_the_model_is_not_asked_of_a_law_that_needs_none(compiled):
    arm = arm_named("two_link")
    controller = make(CONTROLLERS["TDEFONTSM"], arm)
    inputs = rough_run(controller)
    inputs.M[:] = inputs.h[:] = np.nan
    tau, status = compiled(controller).replay(inputs)
    assert not status.any()
    assert worst(tau, inputs) < EXACT


def test_friction_that_is_known_is_added(compiled):
    rubbing = fp.perturb(arm_named("two_link"), friction=0.4, damping=0.2, stiction=1.5)
    arm = with_known_friction(rubbing)
    controller = make(CONTROLLERS["RobustFONFTSM"], arm)
    inputs, c = rough_run(controller), compiled(controller)
    tau, status = c.replay(inputs)
    assert not status.any()
    assert worst(tau, inputs) < EXACT
    assert worst(rough_run(make(CONTROLLERS["RobustFONFTSM"], rubbing)).tau, inputs) > 1e-3
    assert "is known, is added" in c.header.read_text("utf-8")


@pytest.mark.parametrize("single", [False, True])
def test_another_compiler_takes_it_without_a_word(single, tmp_path):
    law = make(CONTROLLERS["RobustFONFTSM"], arm_named("kinova"))
    controller = law if single else fp.Safeguard(fp.ModelLearning(law))
    _, source = fp.export_c(controller, tmp_path, single=single)
    compile_shared([source], tmp_path / "x.o", *STRICT, "-O0", "-c", compiler="clang")
