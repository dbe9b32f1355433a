"""Every broken or hostile URDF ends in one line that says what is wrong, and nothing is made."""

from pathlib import Path

import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.errors import UrdfError

FOLDER = Path(__file__).parent / "hostile"

# What the message must speak of.
SAYS = {
    "billion_laughs": "DOCTYPE",
    "binary": "not well-formed XML",
    "deep_nesting": "nested over 100 deep",
    "duplicate_joint": "two <joint> elements are named 'j'",
    "duplicate_link": "two <link> elements are named 'arm'",
    "empty": "not well-formed XML",
    "external_dtd": "DOCTYPE",
    "floating_base": "'free' is floating",
    "incomplete_inertia": '<inertia ixy="...">',
    "inertial_without_inertia": '<inertia ixx="...">',
    "inertial_without_mass": "'arm': <inertial> has no <mass",
    "infinite_inertia": 'ixx="inf"',
    "limits_swapped": "lower limit 1 is not below upper limit -1",
    "loop": "loop",
    "loop_beside_the_base": "loop",
    "nameless_joint": "has no name",
    "nan_limit": 'upper="nan"',
    "nan_mass": 'value="nan"',
    "negative_damping": "damping -1 is negative",
    "negative_effort": "effort limit -10 is negative",
    "negative_mass": "mass -1 kg is negative",
    "negative_mass_of_a_fixed_part": "'tip': mass -0.1 kg is negative",
    "negative_rotor_inertia": "rotor inertia -1 is negative",
    "no_inertia": "'arm', moved by joint 'j', has no <inertial>",
    "no_inertia_in_the_middle": "'arm', moved by joint 'j', has no <inertial>",
    "no_links": "no link",
    "no_moving_joint": "no joint moves",
    "no_parent": "its parent link None",
    "no_robot": "root element is <sdf>",
    "not_xml": "not well-formed XML",
    "parameter_entity": "DOCTYPE",
    "planar_joint": "'j' is planar",
    "reads_a_file": "DOCTYPE",
    "short_vector": 'xyz="0 0"',
    "spherical_joint": "'j' is spherical",
    "two_parents": "'hand' hangs on two joints",
    "two_roots": "'base' and 'stray'",
    "unclosed": "not well-formed XML",
    "unknown_child": "child link 'hand' is not in the file",
    "unknown_encoding": "klingon-8",
    "unknown_joint_type": "type 'hinge'",
    "wordy_inertia": 'ixx="heavy"',
    "wordy_limit": 'effort="strong"',
    "wordy_origin": 'xyz="left 0 0"',
    "xacro": "expand the xacro",
    "zero_axis": "axis is zero",
    "zero_mass": "'arm', moved by joint 'j', has no mass",
}


def test_every_file_has_its_sentence():
    assert {path.stem for path in FOLDER.glob("*.urdf")} == set(SAYS)
    assert len(SAYS) >= 25


@pytest.mark.parametrize("stem", sorted(SAYS))
def test_refused_in_one_line(stem, capfd):
    with pytest.raises(UrdfError) as caught:
        load_arm(FOLDER / f"{stem}.urdf")
    message = str(caught.value)
    assert message.startswith(f"{stem}.urdf: ")
    assert SAYS[stem] in message
    assert "\n" not in message
    assert len(message) < 250
    # The parser behind Pinocchio would add lines of its own.
    assert capfd.readouterr() == ("", "")


def test_a_file_too_large_is_not_parsed(tmp_path):
    path = tmp_path / "huge.urdf"
    with path.open("wb") as file:
        file.truncate(60_000_000)
    with pytest.raises(UrdfError, match="too large"):
        load_arm(path)
