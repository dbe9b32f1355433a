"""`fotsmc margins`: the range in words, what an arm asks for, springs, and the files it leaves."""

import json

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError


def said(*arguments):
    result = CliRunner().invoke(app, ["margins", *map(str, arguments)])
    if result.exception is not None:
        raise result.exception
    return " ".join(result.stdout.split())


def test_both_ranges_and_units_are_said_and_kept(tmp_path):
    text = said("two_link", "--out", tmp_path / "m")
    kept = json.loads((tmp_path / "m/margins.json").read_text("utf-8"))["loops"]
    found = fp.margins(fp.RobustFONFTSM(fp.load_arm("two_link"), 1e-3))
    assert kept["in motion"]["highest"] == pytest.approx(found.highest)
    assert kept["at rest"]["highest"] > 2.0 * kept["in motion"]["highest"]
    for name, loop in kept.items():
        bears = f"bears {loop['lowest']:.3g} to {loop['highest']:.3g} times the nominal one"
        assert f"true inertia, {name} {bears}" in text
    assert "N·m·s/rad" in text
    assert (tmp_path / "m/margins.png").stat().st_size > 10_000


def test_an_arm_without_rotors_is_too_light_for_true_ones_and_told_the_remedy():
    bare = said("panda", "--rotors")
    assert "effort limit / 50: asks for" in bare
    assert "too heavy at panda_joint" in bare
    assert "--armature rotors" in bare
    assert said("panda", "--rotors", "--armature", "rotors").count(": inside.") == 4


def test_a_second_file_is_compared(tmp_path):
    nominal = fp.load_arm("two_link", armature=0.4)
    heavy = fp.perturb(nominal, armature={"joint1": 60.0, "joint2": 60.0})
    heavy.write_urdf(tmp_path / "heavy.urdf")
    text = said("two_link", "--armature", "0.4", "--true", tmp_path / "heavy.urdf")
    assert "too heavy at joint" in text
    assert "more armature" in text


def test_springs_bound_the_bandwidth_on_either_side():
    text = said("two_link", "--armature", "0.4", "--stiffness", "2000")
    assert "Encoders on the motor side: stable up to a bandwidth of" in text
    assert "Encoders on the link side: stable up to a bandwidth of" in text
    assert "with a SpringObserver: stable up to a bandwidth of" in text
    assert "too fast, take --gain bandwidth=" in text


def test_a_law_of_another_form_is_refused():
    with pytest.raises(ArgumentError, match="nominal inertia"):
        said("two_link", "--controller", "TDEFONTSM")
    with pytest.raises(ArgumentError, match="low:high"):
        said("two_link", "--armature", "0.4", "--stiffness", "1:2")
