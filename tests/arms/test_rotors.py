"""Rotor inertia by rule, its absence in words, and joints that move no inertia at all."""

import numpy as np
import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.arms import inspect_arm, load_arm, perturb
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError, UrdfError
from fotsmc_pin.references import Hold

# Effort limit [N·m] and armature [kg·m²] by joint; the page "Bring your own URDF" has the sources.
MEASURED = {
    "FR3": [(87, 0.6057), (87, 0.6057), (87, 0.4625), (87, 0.4625), (12, 0.2055)],
    "PUMA 560": [
        (97.6, 200e-6 * 62.6111**2),
        (186.4, 200e-6 * 107.815**2),
        (89.4, 200e-6 * 53.7063**2),
        (24.2, 33e-6 * 76.0364**2),
        (20.1, 33e-6 * 71.923**2),
        (21.3, 33e-6 * 76.686**2),
    ],
}
ASSUMED = {"Panda": [(87, 0.1), (12, 0.1)], "UR5e": [(150, 0.1), (28, 0.1)]}

POINT = (
    '<link name="{name}"><inertial><origin xyz="{com}"/><mass value="1"/><inertia ixx="0" ixy="0" '
    'ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
)


def test_the_rule_is_the_effort_limit_over_200():
    raw, arm = load_arm("panda"), load_arm("panda", armature="rotors")
    np.testing.assert_array_equal(raw.armature, 0.0)
    np.testing.assert_allclose(arm.armature, raw.effort_limit / 200.0)
    q = arm.neutral
    added = arm.mass_matrix(q) - raw.mass_matrix(q)
    np.testing.assert_allclose(added, np.diag(raw.effort_limit / 200.0), atol=1e-12)
    assert "armature of panda_joint7 estimated as 0.06, effort limit / 200" in arm.notes


@pytest.mark.parametrize("robot", MEASURED)
def test_the_rule_is_of_the_size_that_was_measured(robot):
    for limit, armature in MEASURED[robot]:
        assert 1 / 4 < (limit / 200.0) / armature < 1.05


@pytest.mark.parametrize("robot", ASSUMED)
def test_the_rule_is_of_the_size_that_models_assume(robot):
    for limit, armature in ASSUMED[robot]:
        assert 0.5 < (limit / 200.0) / armature < 8.0


def test_a_joint_whose_file_gives_its_rotor_keeps_it(made, tmp_path):
    path = load_arm(made.chain("revolute", "prismatic"), armature={"joint1": 0.7}).write_urdf(
        tmp_path / "given.urdf"
    )
    arm = load_arm(path, armature="rotors")
    np.testing.assert_allclose(arm.armature, [0.7, 40.0 / 200.0])


def test_the_rule_takes_the_limits_that_are_given_beside_it():
    arm = load_arm("double_pendulum", armature="rotors", effort_limit=10.0)
    np.testing.assert_allclose(arm.armature, 0.05)


def test_a_joint_without_an_effort_limit_is_named_with_the_remedy():
    with pytest.raises(ArgumentError, match=r"joint 'joint1' states no effort limit.*effort_limit"):
        load_arm("double_pendulum", armature="rotors")


def test_another_word_is_refused():
    with pytest.raises(ArgumentError, match="'rotors' for the rule"):
        load_arm("panda", armature="motors")


def test_the_written_file_keeps_the_rotors(tmp_path):
    arm = load_arm("ur5", armature="rotors")
    again = load_arm(perturb(arm, mass_scale=1.2).write_urdf(tmp_path / "true.urdf"))
    np.testing.assert_array_equal(again.armature, arm.armature)


def test_an_arm_without_rotors_is_told_what_that_means():
    (remark,) = inspect_arm(load_arm("panda"), samples=5).remarks
    assert "No rotor inertia (armature) is given for any joint" in remark
    assert 'armature="rotors"' in remark
    (remark,) = inspect_arm(load_arm("panda", armature={"*[1-6]": 0.1}), samples=5).remarks
    assert "given for panda_joint7." in remark
    assert inspect_arm(load_arm("panda", armature="rotors"), samples=5).remarks == ()


class TestNoInertia:
    @pytest.fixture
    def path(self, made):
        return made.file(
            made.link("upper"),
            made.joint("lift", "base", "upper"),
            POINT.format(name="wrist", com="0 0 0"),
            made.joint("spin", "upper", "wrist"),
        )

    def run(self, arm):
        return fp.simulate(arm, fp.ComputedTorque(arm, 1e-3), Hold(arm), 0.01)

    def test_is_refused_by_joint_and_remedy_before_the_first_tick(self, path):
        arm = load_arm(path)
        nominal = load_arm(path, armature=0.1)
        with pytest.raises(UrdfError, match=r"joint 'spin' moves no inertia.*armature=\{'spin'"):
            fp.simulate(arm, fp.ComputedTorque(nominal, 1e-3), Hold(nominal), 0.01)

    def test_is_refused_by_the_dynamics_of_the_arm(self, path):
        arm = load_arm(path)
        with pytest.raises(UrdfError, match="'spin'"):
            arm.forward_dynamics(arm.neutral, np.zeros(2), np.zeros(2))

    def test_may_be_inspected(self, path):
        assert "spin: moves no inertia" in "\n".join(inspect_arm(load_arm(path)).warnings)

    @pytest.mark.parametrize("remedy", [{"armature": {"spin": 0.01}}, {"armature": "rotors"}])
    def test_the_remedies_help(self, path, remedy):
        assert np.isfinite(self.run(load_arm(path, **remedy)).q).all()

    def test_a_point_mass_off_its_axis_is_no_matter(self, made):
        parts = POINT.format(name="ball", com="0.3 0 0"), made.joint("swing", "base", "ball")
        assert np.isfinite(self.run(load_arm(made.file(*parts))).q).all()

    def test_two_axes_that_are_one_are_found(self, made):
        """A light frame between two joints on one axis: only their sum meets inertia."""
        coincident = made.joint("second", "frame", "arm").replace(
            'xyz="0.4 0 0" rpy="0.1 0.2 0.3"', 'xyz="0 0 0"'
        )
        path = made.file(
            POINT.format(name="frame", com="0 0 0"),
            made.joint("first", "base", "frame"),
            made.link("arm"),
            coincident,
        )
        arm = load_arm(path)
        with pytest.raises(UrdfError, match=r"joint .(first|second). moves no"):
            arm.forward_dynamics(arm.neutral, np.zeros(2), np.zeros(2))


def test_the_command_line_knows_the_word(monkeypatch, tmp_path):
    monkeypatch.setenv("COLUMNS", "200")

    def call(*words):
        return CliRunner().invoke(app, [str(word) for word in words]).output

    assert "No rotor inertia" in call("inspect", "panda", "--samples", "5")
    with_rotors = call("inspect", "panda", "--samples", "5", "--armature", "rotors")
    assert "No rotor inertia" not in with_rotors
    assert "0.435" in with_rotors
    out = tmp_path / "true.urdf"
    call("perturb", "panda", "-o", out, "--armature", "rotors")
    np.testing.assert_allclose(load_arm(out).armature[-1], 0.06)
