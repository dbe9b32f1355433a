"""Perturbed arms keep their promises: real bodies, said changes, the same from the written file."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fotsmc_pin.arms import Payload, Uniform, load_arm, perturb
from fotsmc_pin.arms.catalog import EXAMPLE_ROBOTS
from fotsmc_pin.arms.inertia import read_inertia
from fotsmc_pin.arms.perturbation import moving_links
from fotsmc_pin.errors import ArgumentError


def random_states(arm, count=20):
    rng = np.random.default_rng(0)
    return [(arm.random_configuration(rng), rng.normal(size=arm.nv)) for _ in range(count)]


@pytest.mark.parametrize("name", [*EXAMPLE_ROBOTS, "two_link"])
def test_written_urdf_loads_to_the_same_dynamics(tmp_path, name, worst_difference):
    true = perturb(
        load_arm(name),
        mass_scale=1.3,
        inertia_scale={"*": Uniform(0.8, 1.2)},
        com_shift=0.01,
        payload=2.0,
        armature=0.1,
        friction=Uniform(0, 1),
        damping=0.3,
        seed=4,
    )
    again = load_arm(true.write_urdf(tmp_path / "true.urdf"))
    assert worst_difference(true, again) < 1e-10
    for what in ("friction", "damping", "armature", "effort_limit", "upper_position_limit"):
        np.testing.assert_array_equal(getattr(true, what), getattr(again, what))
    assert again.tool_frame == true.tool_frame


def test_the_written_file_states_the_changes_and_keeps_the_rest(tmp_path):
    arm = load_arm("xarm7")
    true = perturb(perturb(arm, mass_scale=1.1), payload=Payload(mass=1.5), friction=0.4)
    text = true.write_urdf(tmp_path / "true.urdf").read_text()
    head = text[: text.index("<robot")]
    assert true.changes == (
        "mass and inertia of all × 1.1",
        "payload_1 of 1.5 kg at link_eef",
        "friction of all = 0.4",
    )
    for change in true.changes:
        assert change in head
    original = ET.fromstring(arm.urdf)
    copy = ET.fromstring(text)
    for tag in ("mesh", "collision", "transmission", "hardwareInterface"):
        assert len(list(copy.iter(tag))) == len(list(original.iter(tag))) > 0


def test_no_change_is_no_change(worst_difference):
    arm = load_arm("panda")
    same = perturb(arm)
    assert same.changes == ()
    assert worst_difference(arm, same) == 0.0


def test_mass_scale_scales_every_term():
    arm = load_arm("ur5")
    heavy = perturb(arm, mass_scale=1.5)
    for q, v in random_states(arm):
        np.testing.assert_allclose(heavy.mass_matrix(q), 1.5 * arm.mass_matrix(q), rtol=1e-12)
        np.testing.assert_allclose(heavy.gravity(q), 1.5 * arm.gravity(q), atol=1e-12)
        np.testing.assert_allclose(
            heavy.coriolis(q, v) @ v, 1.5 * arm.coriolis(q, v) @ v, atol=1e-12
        )


def test_mass_scale_by_link_leaves_the_others_alone():
    arm = load_arm("panda")
    true = perturb(arm, mass_scale={"panda_link[67]": 2.0})
    for link in moving_links(arm.tree):
        ratio = read_inertia(true.tree, link).mass / read_inertia(arm.tree, link).mass
        assert ratio == (2.0 if link in ("panda_link6", "panda_link7") else 1.0)
    assert len(true.changes) == 2


def test_a_payload_adds_the_dynamics_of_its_body():
    """A point mass at the tool of the two-link arm adds to m2 alone."""
    arm = load_arm("two_link")
    true = perturb(arm, payload=Payload(mass=0.3, inertia=(0.0, 0.0, 0.0)))
    heavier = perturb(arm, mass_scale={"link2": 1.5 / 1.2})
    for q, v in random_states(arm):
        np.testing.assert_allclose(true.mass_matrix(q), heavier.mass_matrix(q), atol=1e-12)
        np.testing.assert_allclose(true.gravity(q), heavier.gravity(q), atol=1e-12)
        np.testing.assert_allclose(true.coriolis(q, v), heavier.coriolis(q, v), atol=1e-12)


def test_a_payloads_inertia_and_place_count():
    arm = load_arm("panda")
    q = arm.neutral
    plain = perturb(arm, payload=Payload(mass=1.0, inertia=np.zeros(3))).mass_matrix(q)
    spun = perturb(arm, payload=Payload(mass=1.0, inertia=(0.1, 0.1, 0.1))).mass_matrix(q)
    # A body that turns with the last joint adds its moment about that joint's axis.
    assert spun[-1, -1] - plain[-1, -1] == pytest.approx(0.1)
    off = perturb(arm, payload=Payload(mass=1.0, inertia=np.zeros(3), com=(0.1, 0.0, 0.0)))
    assert off.mass_matrix(q)[-1, -1] - plain[-1, -1] == pytest.approx(0.01)


def test_several_payloads_where_they_are_put():
    arm = load_arm("panda")
    bodies = [Payload(mass=1.0), Payload(mass=0.5, frame="panda_link4")]
    true = perturb(arm, payload=bodies)
    assert true.changes[1] == "payload_2 of 0.5 kg at panda_link4"
    assert perturb(true, payload=0.1).changes[2].startswith("payload_3 of 0.1 kg")


def test_com_shift_moves_gravity_by_the_weight_times_the_shift():
    arm = load_arm("two_link")
    true = perturb(arm, com_shift={"link2": (0.1, 0.0, 0.0)})
    q = np.zeros(2)
    np.testing.assert_allclose(true.gravity(q) - arm.gravity(q), 1.2 * 9.81 * 0.1 * np.ones(2))


def test_a_length_is_shifted_somewhere():
    arm = load_arm("panda")
    true = perturb(arm, com_shift=0.02, seed=1)
    shifts = [
        read_inertia(true.tree, link).com - read_inertia(arm.tree, link).com
        for link in moving_links(arm.tree)
    ]
    np.testing.assert_allclose(np.linalg.norm(shifts, axis=1), 0.02)
    assert np.ptp(np.array(shifts), axis=0).min() > 0.005


def test_one_seed_draws_one_arm():
    arm, options = load_arm("ur5"), {"mass_scale": Uniform(0.7, 1.3), "payload": Uniform(0, 3)}
    one, two = perturb(arm, **options, seed=7), perturb(arm, **options, seed=7)
    other = perturb(arm, **options, seed=8)
    assert one == two
    assert one.urdf != other.urdf
    assert one.changes[-1] == "drawn from seed 7"


def test_another_argument_does_not_disturb_a_draw():
    arm = load_arm("ur5")
    lean = perturb(arm, mass_scale=Uniform(0.7, 1.3), seed=7)
    rich = perturb(arm, mass_scale=Uniform(0.7, 1.3), friction=Uniform(0, 1), com_shift=0.1, seed=7)
    assert lean.changes[:-1] == rich.changes[: len(lean.changes) - 1]


@pytest.mark.parametrize("option", [{"mass_scale": Uniform(0.9, 1.1)}, {"com_shift": 0.01}])
def test_chance_without_a_seed_is_refused(option):
    with pytest.raises(ArgumentError, match="seed"):
        perturb(load_arm("ur5"), **option)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    name=st.sampled_from(["panda", "z1", "talos_arm", "so101", "ur10", "two_link", "baxter"]),
    spread=st.floats(0.0, 0.9),
)
def test_every_draw_is_a_real_body(seed, name, spread):
    """Second moments of mass below zero are what the triangle inequality forbids."""
    true = perturb(
        load_arm(name),
        mass_scale=Uniform(1 - spread, 1 + spread),
        inertia_scale=Uniform(1 - spread, 1 + spread),
        com_shift=Uniform(0, 0.1 * spread),
        payload=Uniform(0, 5 * spread),
        seed=seed,
    )
    for link in moving_links(true.tree):
        inertia = read_inertia(true.tree, link)
        assert inertia.mass > 0.0
        assert inertia.is_consistent()
    for body in true.model.inertias[1:]:
        assert np.linalg.eigvalsh(body.toPseudoInertia().toMatrix())[0] > -1e-9
    mass = true.mass_matrix(true.random_configuration(np.random.default_rng(seed)))
    assert np.linalg.eigvalsh(mass)[0] > 0.0


def test_impossible_inertias_are_raised_to_possible_ones(made):
    impossible = (
        '<link name="link1"><inertial><origin xyz="0.1 0 0" rpy="0 0 0.3"/><mass value="2"/>'
        '<inertia ixx="1" ixy="0.1" ixz="0" iyy="0.2" iyz="0" izz="0.3"/></inertial></link>'
    )
    arm = load_arm(made.file(impossible, made.joint("turn", "base", "link1")))
    assert not read_inertia(arm.tree, "link1").is_consistent()
    true = perturb(arm, mass_scale=1.1)
    inertia = read_inertia(true.tree, "link1")
    assert inertia.is_consistent()
    assert np.linalg.eigvalsh(inertia.about_com)[0] > 0.0
    assert "inertia of link1 raised to obey the triangle inequality" in true.changes


@pytest.mark.parametrize(
    "option",
    [
        {"mass_scale": 0.0},
        {"mass_scale": -1.0},
        {"mass_scale": {"nose": 2.0}},
        {"mass_scale": np.nan},
        {"inertia_scale": 0.0},
        {"com_shift": (1.0, 2.0)},
        {"com_shift": -0.1},
        {"payload": -1.0},
        {"payload": ["brick"]},
        {"friction": -1.0},
        {"friction": [1.0]},
        {"damping": {"nose": 1.0}},
        {"armature": np.inf},
        {"seed": 1.5, "mass_scale": 1.1},
    ],
)
def test_bad_numbers_are_named(option):
    with pytest.raises(ArgumentError, match=next(iter(option))):
        perturb(load_arm("panda"), **option)


@pytest.mark.parametrize(
    "option",
    [
        {"mass": -1.0},
        {"mass": 1.0, "inertia": (1.0, 0.1, 0.1)},
        {"mass": 1.0, "inertia": np.ones((2, 2))},
        {"mass": 1.0, "com": (0.0, np.nan, 0.0)},
    ],
)
def test_bad_payloads_are_refused(option):
    with pytest.raises(ArgumentError):
        Payload(**option)


def test_a_payload_on_no_link_is_refused():
    with pytest.raises(ArgumentError, match="frame"):
        perturb(load_arm("panda"), payload=Payload(mass=1.0, frame="nose"))


def test_bounds_in_the_wrong_order_are_refused():
    with pytest.raises(ArgumentError, match="high"):
        Uniform(2.0, 1.0)
