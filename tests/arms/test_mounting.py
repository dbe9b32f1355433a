"""Arms on walls and ceilings: gravity in the base's frame, kept wherever an arm goes."""

import pickle

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import load_arm, perturb
from fotsmc_pin.errors import ArgumentError, UrdfError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import Recording

WALL, CEILING = (9.81, 0.0, 0.0), (0.0, 0.0, 9.81)
DIRECTIONS = [
    WALL,
    CEILING,
    (0.0, -9.81, 0.0),
    (1.0, 2.0, -3.0),
    (0.0, 0.0, -1.62),
    (0.0, 0.0, 0.0),
]


def states(arm, count=10):
    rng = np.random.default_rng(0)
    for _ in range(count):
        yield arm.random_configuration(rng), rng.normal(size=arm.nv), rng.normal(size=arm.nv)


@pytest.mark.parametrize("gravity", DIRECTIONS)
@pytest.mark.parametrize("name", ["panda", "kinova"])
def test_the_arm_feels_what_pinocchio_computes_with_that_gravity(name, gravity):
    plain, arm = load_arm(name), load_arm(name, gravity=gravity)
    model = plain.model.copy()
    model.gravity.linear = np.array(gravity)
    data = model.createData()
    assert arm.joint_names == plain.joint_names
    np.testing.assert_allclose(arm.base_gravity, gravity, atol=1e-14)
    for q, v, tau in states(arm):
        np.testing.assert_allclose(
            arm.gravity(q), pin.computeGeneralizedGravity(model, data, q), atol=1e-11
        )
        np.testing.assert_allclose(arm.mass_matrix(q), plain.mass_matrix(q), atol=1e-12)
        there = pin.aba(model, data, q, v, tau)
        np.testing.assert_allclose(arm.forward_dynamics(q, v, tau), there, rtol=1e-8, atol=1e-7)


@pytest.mark.parametrize("gravity", DIRECTIONS)
def test_it_is_kept_by_files_perturbations_pickles_and_recordings(
    gravity, tmp_path, worst_difference
):
    arm = load_arm("ur5", gravity=gravity)
    true = perturb(arm, mass_scale=1.2, payload=1.0)
    written = load_arm(true.write_urdf(tmp_path / "true.urdf"))
    rec = fp.simulate(true, fp.ComputedTorque(arm, 1e-3), Hold(arm), 0.01)
    rec.save(tmp_path / "run.npz")
    again = Recording.load(tmp_path / "run.npz")
    for other in (written, pickle.loads(pickle.dumps(true)), again.arm):
        assert worst_difference(true, other) < 1e-10
        np.testing.assert_allclose(other.base_gravity, gravity, atol=1e-14)
        assert other.tool_frame == arm.tool_frame
    np.testing.assert_allclose(again.metadata["gravity"], gravity, atol=1e-14)


def test_another_program_sees_the_same_arm_in_the_written_file(tmp_path):
    """The turned base is plain URDF: Pinocchio's own reader, with its own gravity, agrees."""
    arm = load_arm("ur5", gravity=WALL)
    model = pin.buildModelFromUrdf(str(arm.write_urdf(tmp_path / "wall.urdf")))
    data = model.createData()
    for q, _, _ in states(arm):
        there = pin.computeGeneralizedGravity(model, data, q)
        np.testing.assert_allclose(arm.gravity(q), there, atol=1e-10)


def test_the_base_is_turned_so_that_down_is_down():
    """An arm on the ceiling reaches down where it reached up."""
    plain, arm = load_arm("panda"), load_arm("panda", gravity=CEILING)
    for q, _, _ in states(arm, 3):
        tips = []
        for each in (plain, arm):
            data = each.model.createData()
            pin.framesForwardKinematics(each.model, data, q)
            tips.append(data.oMf[each.tool_frame_id].translation.copy())
        np.testing.assert_allclose(tips[1], tips[0] * [1.0, -1.0, -1.0], atol=1e-12)


def test_a_file_of_a_turned_base_may_be_turned_anew(tmp_path):
    path = load_arm("ur5", gravity=WALL).write_urdf(tmp_path / "wall.urdf")
    for gravity in (CEILING, (0.0, 0.0, -9.81), (0.0, 0.0, -3.7)):
        again = load_arm(path, gravity=gravity)
        np.testing.assert_allclose(again.base_gravity, gravity, atol=1e-14)
        plain = load_arm("ur5", gravity=gravity)
        np.testing.assert_allclose(again.gravity(again.neutral), plain.gravity(plain.neutral))
        assert len(again.tree.links) == len(load_arm(path).tree.links), "one mount is enough"


def test_standard_gravity_changes_nothing():
    arm = load_arm("ur5", gravity=(0.0, 0.0, -9.81))
    assert arm.tree.links.keys() == load_arm("ur5").tree.links.keys()


def test_it_is_said():
    notes = load_arm("ur5", gravity=WALL).notes
    assert "gravity is (9.81, 0, 0) m/s², in the frame of its base: the base is turned" in notes


@pytest.mark.parametrize("gravity", [9.81, (0.0, 0.0), (0.0, 0.0, np.nan), "down"])
def test_what_is_no_vector_is_refused(gravity):
    with pytest.raises(ArgumentError, match="gravity"):
        load_arm("ur5", gravity=gravity)


def test_a_tag_that_holds_no_gravity_is_refused(tmp_path):
    path = tmp_path / "bad.urdf"
    text = load_arm("two_link").urdf.replace("<fotsmc_pin", '<fotsmc_pin gravity="-3"')
    path.write_text(text)
    with pytest.raises(UrdfError, match=r"gravity=.-3.* is negative"):
        load_arm(path)
