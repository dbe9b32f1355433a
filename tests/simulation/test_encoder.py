"""An encoder of 17 or 20 bits and no velocity sensor: its steps, its velocity, and who bears it."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import FilteredDifferentiator
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import Encoder, simulate

DT = 1e-3


@pytest.mark.parametrize("bits", [12, 17, 20])
def test_readings_stand_on_the_steps_of_a_turn(bits):
    arm = fp.load_arm("kinova")
    encoder = Encoder(arm, DT, bits=bits)
    step = 2.0 * np.pi / 2**bits
    np.testing.assert_allclose(encoder.step, step)
    rng = np.random.default_rng(0)
    for _ in range(20):
        angles = rng.uniform(-3.0, 3.0, 6)
        q, _ = encoder(0.0, arm.from_joint_positions(angles), np.zeros(6))
        read = arm.to_joint_positions(q)
        np.testing.assert_allclose(read / step, np.round(angles / step), atol=1e-6)


def test_the_velocity_is_a_differentiators_and_not_the_true_one():
    arm = fp.load_arm("two_link")
    encoder = Encoder(arm, DT, bits=20)
    by_hand = FilteredDifferentiator(arm, DT)
    for k in range(500):
        true = np.array([0.7, -0.2])
        q, v = encoder(k * DT, true * k * DT, np.full(2, np.nan))
        np.testing.assert_array_equal(v, by_hand.update(q))
    np.testing.assert_allclose(v, true, atol=6e-3)


def test_a_step_in_bits_is_halved_by_each_and_divided_by_a_gear():
    arm = fp.load_arm("ur5")
    one, two = (Encoder(arm, DT, bits=bits).step for bits in (17, 18))
    np.testing.assert_allclose(one, 2.0 * two)
    geared = Encoder(arm, DT, bits=17, turn=2.0 * np.pi / 100.0).step
    np.testing.assert_allclose(geared, one / 100.0)


def test_a_slide_has_the_lead_of_a_screw(tmp_path):
    path = tmp_path / "slider.urdf"
    path.write_text(
        '<robot name="s"><link name="a"/><link name="b"><inertial><mass value="2"/><inertia '
        'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" '
        'type="prismatic"><parent link="a"/><child link="b"/></joint></robot>'
    )
    assert Encoder(fp.load_arm(path), DT, bits=10).step == pytest.approx(0.02 / 1024)


def test_runs_are_repeated_to_the_bit():
    arm = fp.load_arm("two_link")
    encoder = Encoder(arm, DT)
    law, reference = fp.RobustFONFTSM(arm, DT), Sinusoid.inside_limits(arm)
    one, two = (simulate(arm, law, reference, 0.2, sensor=encoder) for _ in range(2))
    np.testing.assert_array_equal(one.tau, two.tau)


@pytest.mark.parametrize("bits", [17, 20])
def test_more_bits_are_less_noise(bits):
    """A slow motion, whose steps come one by one: the velocity errs by a step in a few ticks."""
    arm = fp.load_arm("two_link")
    encoder = Encoder(arm, DT, bits=bits, differentiator=FilteredDifferentiator(arm, DT))
    errors = []
    for k in range(3000):
        t = k * DT
        position = 0.5 * np.sin(0.5 * t) * np.ones(2)
        _, v = encoder(t, position, np.zeros(2))
        errors.append(v[0] - 0.25 * np.cos(0.5 * t))
    noise = np.std(errors[1000:])
    step = 2.0 * np.pi / 2**bits
    assert 0.01 * step / DT < noise < 2.0 * step / DT + 2e-3


@pytest.mark.parametrize(
    "options", [{"bits": 0}, {"bits": 17.5}, {"turn": 0.0}, {"turn": [1.0, 2.0, 3.0]}]
)
def test_bad_numbers_are_refused(options):
    with pytest.raises(ArgumentError, match=next(iter(options))):
        Encoder(fp.load_arm("two_link"), DT, **options)


def test_the_robust_law_bears_it():
    arm = fp.load_arm("two_link")
    true = fp.perturb(arm, mass_scale=1.2)
    law = fp.RobustFONFTSM(arm, DT)
    reference = Sinusoid.inside_limits(arm)
    rec = simulate(true, law, reference, 4.0, sensor=Encoder(arm, DT, bits=20))
    assert fp.summarize(rec).max_tail_error < 5e-3
