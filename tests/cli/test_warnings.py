"""Warnings: for every law that they concern, each in one line on the error stream."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS, GravityWarning, TickWarning
from fotsmc_pin.references import ReferenceWarning, Sinusoid, warn_of_limits


def warnings_of(result):
    """The lines of warnings; there is nothing else on the error stream."""
    assert result.returncode == 0, result.stderr
    lines = result.stderr.splitlines()
    assert all(line.startswith("fotsmc: warning: ") for line in lines), result.stderr
    return lines


def test_a_quiet_run_warns_of_nothing(fotsmc):
    words = ("simulate", "two_link", "--duration", "1", "--out", "run")
    assert warnings_of(fotsmc(*words)) == []


def test_a_model_without_rotors_is_named_with_the_remedy(fotsmc):
    words = ("--duration", "0.2", "--out", "run")
    (line,) = [line for line in warnings_of(fotsmc("simulate", "ur5", *words)) if "rotor" in line]
    assert 'armature="rotors"' in line
    helped = warnings_of(fotsmc("simulate", "ur5", "--armature", "rotors", *words, "--force"))
    assert not any("rotor" in line for line in helped)


def test_a_run_that_never_settles_says_so_with_its_joint(fotsmc):
    words = ("--controller", "ComputedTorque", "--payload", "8", "--duration", "2", "--out", "run")
    result = fotsmc("simulate", "panda", *words)
    (line,) = [line for line in warnings_of(result) if "settle" in line]
    assert "panda_joint" in line
    assert "mrad off" in line
    assert "never" in result.stdout
    assert " inf" not in result.stdout


def test_a_reference_beyond_the_limits_is_named_with_joint_and_time(fotsmc, tmp_path):
    t = np.linspace(0.0, 2.0, 41)
    rows = np.column_stack([t, 0.3 * np.sin(12.0 * t), 0.2 * np.sin(12.0 * t)])
    np.savetxt(tmp_path / "fast.csv", rows, delimiter=",")
    text = (fp.arms.catalog.urdf_folder() / "two_link_nominal.urdf").read_text()
    (tmp_path / "weak.urdf").write_text(text.replace('effort="1000"', 'effort="25"'))
    result = fotsmc("simulate", "weak.urdf", "--reference", "fast.csv", "--out", "run")
    (line,) = [line for line in warnings_of(result) if "the reference asks for more" in line]
    assert "joint1: effort" in line
    assert " s, limit 25 N·m" in line


def test_slow_ticks_are_named_with_the_gain_and_the_longest_period(fotsmc):
    words = ("--controller", "ComputedTorque", "--dt", "0.02", "--duration", "1", "--out", "run")
    (line,) = [
        line for line in warnings_of(fotsmc("simulate", "two_link", *words)) if "slow" in line
    ]
    assert "kd" in line
    assert "at most" in line


@pytest.mark.parametrize("law", CONTROLLERS.values(), ids=CONTROLLERS)
@pytest.mark.filterwarnings("ignore::fotsmc_pin.control.PaperConditionWarning")
def test_every_law_warns_of_an_arm_that_cannot_hold_itself(law):
    with pytest.warns(GravityWarning, match="arm_left"):
        law(fp.load_arm("talos_arm"), 1e-3)


def test_ticks_warn_where_the_sampled_rate_loses_its_damping():
    arm = fp.load_arm("two_link")
    fp.LinearSMC(arm, 1e-3, Lambda=499.0)
    with pytest.warns(TickWarning, match=r"Lambda \(501 rad/s\): take at most 1 ms"):
        fp.LinearSMC(arm, 1e-3, Lambda=501.0)
    with pytest.warns(TickWarning, match=r"kp \(600 rad/s\)"):
        fp.ComputedTorque(arm, 1e-3, kp=360_000.0)


@pytest.mark.parametrize("law", CONTROLLERS.values(), ids=CONTROLLERS)
@pytest.mark.filterwarnings("ignore::fotsmc_pin.control.PaperConditionWarning")
def test_no_law_warns_of_the_ticks_that_it_is_made_for(law):
    for preset in law.presets:
        law(fp.load_arm("two_link"), 1e-3, preset=preset)


def test_a_reference_inside_the_limits_is_no_cause_to_warn():
    arm = fp.load_arm("panda")
    inside = Sinusoid.inside_limits(arm)
    warn_of_limits(arm, inside, 10.0)
    fast = Sinusoid(arm=arm, center=inside.center, amplitude=np.full(7, 0.3), period=0.5)
    with pytest.warns(ReferenceWarning, match=r"panda_joint1: velocity .* rad/s at .* s, limit"):
        warn_of_limits(arm, fast, 10.0)
