"""`inspect_arm` measures what it says and finds what is wrong."""

import numpy as np
import pytest

from fotsmc_pin.arms import Payload, inspect_arm, load_arm, perturb


def warnings_of(path, **options):
    return "\n".join(inspect_arm(load_arm(path, **options), samples=50).warnings)


def test_a_sound_arm_has_no_warnings():
    found = inspect_arm(load_arm("panda"))
    assert found.warnings == ()
    assert 0.5 < found.gravity_share.max() < 1.0
    assert found.condition[0] < found.condition[1] < 1e4


def test_the_payload_brings_the_weakest_joint_to_its_limit():
    arm = load_arm("panda")
    found = inspect_arm(arm, samples=50)
    for share, fits in ((0.999, True), (1.001, False)):
        body = Payload(mass=share * found.payload, inertia=np.zeros(3))
        loaded = inspect_arm(perturb(arm, payload=body), samples=50)
        assert (loaded.gravity_share.max() <= 1.0) == fits


def test_an_arm_that_cannot_hold_itself_is_told():
    found = inspect_arm(load_arm("talos_arm"))
    assert found.payload == 0.0
    assert found.gravity_share.max() == pytest.approx(1.23, abs=0.05)
    assert "cannot hold itself" in "\n".join(found.warnings)


def test_limits_not_given_are_told():
    text = warnings_of("double_pendulum")
    for what in ("effort limit", "velocity limit", "position limits"):
        assert f"no {what}" in text
    assert "0 or inf means not given" in text


def test_absurd_limits_are_told():
    text = warnings_of("baxter")
    assert "head_pan: effort limit 50000 is beyond any arm's" in text
    assert "head_pan: velocity limit 10000 is beyond any arm's" in text


@pytest.mark.parametrize(
    ("inertia", "mass", "words"),
    [
        ('ixx="0" iyy="0" izz="0"', 1.0, "zero rotational inertia"),
        ('ixx="1e-3" iyy="1e-4" izz="1e-4"', 1.0, "no body has principal moments"),
        ('ixx="1" iyy="1" izz="1"', 0.1, "check its unit"),
    ],
)
def test_absurd_inertias_are_told(made, inertia, mass, words):
    link = (
        f'<link name="arm"><inertial><mass value="{mass}"/><inertia {inertia} ixy="0" ixz="0" '
        'iyz="0"/></inertial></link>'
    )
    text = warnings_of(made.file(link, made.joint("turn", "base", "arm")))
    assert text.startswith("arm: ")
    assert words in text


def test_a_centre_of_mass_far_away_is_told(made):
    path = made.chain("revolute", "revolute")
    path.write_text(path.read_text().replace('<origin xyz="0.2 0 0.01"', '<origin xyz="200 0 10"'))
    assert "centre of mass lies 200 m away" in warnings_of(path)


def test_a_drawn_link_without_mass_is_told(made):
    box = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    tail = (
        f'<link name="hull">{box}</link>',
        made.joint("glue", "link1", "hull", "fixed", "0 0 1", ""),
    )
    assert "hull: is drawn and weighs nothing" in warnings_of(made.chain("revolute", tail=tail))


def test_missing_meshes_are_told(made):
    mesh = '<visual><geometry><mesh filename="gone.stl"/></geometry></visual>'
    path = made.file(made.link("arm", extra=mesh), made.joint("turn", "base", "arm"))
    assert "gone.stl' is not there" in warnings_of(path)


def test_an_ill_conditioned_mass_matrix_is_told():
    assert "condition number" in warnings_of("ur5", armature={"wrist_3_joint": 1e9})
