"""An excitation keeps every bound, can be repeated, and shows more than motions drawn at random."""

import time

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms.self_collision import collision_model
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Excitation, Spline, broken_limits
from fotsmc_pin.references import excitation_design as design
from fotsmc_pin.references.fourier import RestingSeries

SHORT = {"harmonics": 4, "repetitions": 2, "period": 6.0}
MOTIONS = {
    "two_link": {"seed": 1},
    "z1": {"seed": 2, **SHORT},
    "so100": {"seed": 0, "effort_share": 0.5, "floor": 0.0, **SHORT},
    "kinova": {"seed": 3, **SHORT},
    "panda": {"seed": 4, **SHORT},
}
OTHERS = ("ur3", "ur5", "ur10", "xarm7", "so101", "talos_arm", "asr_twodof", "finger_edu")


def quick(monkeypatch):
    """A short search: bounds are kept at the end of any search."""
    monkeypatch.setattr(design, "STARTS", 1)
    monkeypatch.setattr(design, "CANDIDATES", 3)
    monkeypatch.setattr(design, "PENALTIES", ((30.0, 3), (3000.0, 7)))


@pytest.fixture(scope="module")
def motions():
    with pytest.MonkeyPatch.context() as patch:
        quick(patch)
        return {name: Excitation(fp.load_arm(name), **asked) for name, asked in MOTIONS.items()}


@pytest.fixture(params=sorted(MOTIONS))
def motion(request, motions):
    return motions[request.param]


def assert_bounds(motion, steps=2503):
    """Look at one period, at other times than the search did, and half as far apart."""
    arm, t = motion.arm, np.linspace(0.0, motion.period, steps)
    x, v, a = motion.joint_motion(t)
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    margin = motion.position_margin * np.where(np.isfinite(upper - lower), upper - lower, 0.0)
    neutral = arm.to_joint_positions(arm.neutral)
    # The range may be cut at π from neutral: the margin is then a share of what is left.
    gap = np.minimum(margin, motion.position_margin * 2.0 * np.pi) * 0.5
    assert np.all((x > lower + gap) & (x < upper - gap))
    assert np.all(np.abs(x - neutral) < np.pi)
    assert np.all(np.abs(v) <= motion.velocity_share * arm.velocity_limit)
    assert np.all(np.abs(a) <= motion.room.acceleration)
    efforts = np.array([arm.inverse_dynamics(*row) for row in zip(*motion.at(t), strict=True)])
    efforts += arm.damping * v + arm.friction * np.sign(v)
    assert np.all(np.abs(efforts) <= motion.effort_share * arm.effort_limit)
    assert not broken_limits(arm, motion, samples=500, effort_share=motion.effort_share)


def touches(motion, steps):
    """Whether any shapes touch that the custom looks at: Pinocchio's check, on the meshes."""
    arm = motion.arm
    shapes, model = collision_model(arm), arm.model
    shapes.addAllCollisionPairs()
    data, joints = model.createData(), [g.parentJoint for g in shapes.geometryObjects]
    state = shapes.createData()
    pin.computeCollisions(model, data, shapes, state, arm.neutral, False)
    for k, pair in reversed(list(enumerate(shapes.collisionPairs))):
        a, b = joints[pair.first], joints[pair.second]
        connected = a == b or model.parents[a] == b or model.parents[b] == a
        if connected or state.collisionResults[k].isCollision():
            shapes.removeCollisionPair(pin.CollisionPair(pair.first, pair.second))
    state = shapes.createData()
    q, _, _ = motion.at(np.linspace(0.0, motion.period, steps))
    return [k for k, row in enumerate(q) if pin.computeCollisions(model, data, shapes, state, row)]


def test_it_keeps_its_bounds(motion):
    assert_bounds(motion)


def test_it_touches_nothing(motion):
    assert touches(motion, 1001) == []


def test_it_begins_and_ends_each_period_at_rest_in_one_place(motion):
    q, v, a = motion.at(np.array([0.0, motion.period, motion.duration, motion.duration + 9.0]))
    np.testing.assert_allclose(v, 0.0, atol=1e-9)
    np.testing.assert_allclose(a, 0.0, atol=1e-9)
    np.testing.assert_allclose(q, q[[0, 0, 0, 0]], atol=1e-9)
    assert motion.duration == motion.period * motion.repetitions


def test_derivatives_are_those_of_the_motion(motion):
    t, h = np.linspace(0.5, 5.5, 7), 1e-5
    for instant in t:
        q, v, a = motion(instant)
        before, after = motion(instant - h), motion(instant + h)
        np.testing.assert_allclose(
            motion.arm.difference(before[0], after[0]) / (2 * h), v, atol=1e-6
        )
        np.testing.assert_allclose((after[1] - before[1]) / (2 * h), a, atol=1e-6)
        assert q.shape == (motion.arm.nq,)


def test_every_joint_moves(motion):
    x, _, _ = motion.joint_motion(np.linspace(0.0, motion.period, 500))
    assert np.all(np.ptp(x, axis=0) > 0.05)


def test_no_link_goes_below_the_floor(motions):
    motion = motions["so100"]
    shapes, arm = collision_model(motion.arm), motion.arm
    data, state = arm.model.createData(), shapes.createData()
    for q in motion.at(np.linspace(0.0, 6.0, 60))[0]:
        pin.updateGeometryPlacements(arm.model, data, shapes, state, q)
        for shape, place in zip(shapes.geometryObjects, state.oMg, strict=True):
            if shape.parentJoint > 0:
                points = shape.geometry.vertices() if hasattr(shape.geometry, "vertices") else []
                assert all((place.rotation @ np.asarray(points).T)[2] + place.translation[2] > 0.0)


def test_the_same_seed_gives_the_same_motion_and_another_one_another(motions, monkeypatch):
    quick(monkeypatch)
    again = Excitation(fp.load_arm("two_link"), **MOTIONS["two_link"])
    other = Excitation(fp.load_arm("two_link"), seed=7)
    for k in range(3):
        np.testing.assert_array_equal(again(1.3)[k], motions["two_link"](1.3)[k])
    assert not np.allclose(other(1.3)[0], again(1.3)[0])


def test_the_search_makes_parameters_more_visible_than_chance(monkeypatch):
    monkeypatch.setattr(design, "STARTS", 1)
    motion = Excitation(fp.load_arm("asr_twodof"))
    cost, rng = motion._cost, np.random.default_rng(11)
    drawn = [
        design.inside(cost, design.random_motion(cost, rng, design._middle(cost, rng)))
        for _ in range(9)
    ]
    sizes = [np.linalg.eigvalsh(cost.information(one)) for one in drawn]
    conditions = [np.sqrt(size[-1] / size[0]) for size in sizes]
    assert motion.condition_number < 0.25 * np.median(conditions)
    variances = [design.variance(cost, one) for one in drawn]
    assert design.variance(cost, motion._coefficients) < 0.7 * min(variances)


def test_the_gradient_of_the_cost_is_its_slope(motions):
    for name in ("two_link", "kinova"):
        cost = motions[name]._cost
        cost.penalty = 30.0
        rng = np.random.default_rng(0)
        flat = motions[name]._coefficients.ravel() + 0.05 * rng.standard_normal(
            motions[name]._coefficients.size
        )
        _, gradient = cost(flat)
        for direction in rng.standard_normal((3, flat.size)):
            step = 1e-5 * direction
            slope = (cost(flat + step)[0] - cost(flat - step)[0]) / 2e-5
            assert slope == pytest.approx(gradient @ direction, rel=2e-3, abs=2e-3)


@pytest.mark.parametrize("name", ["kinova", "z1"])
def test_the_csv_file_is_a_reference_again(motions, name, tmp_path):
    motion = motions[name]
    motion.to_csv(tmp_path / "motion.csv")
    arm = motion.arm
    head = (tmp_path / "motion.csv").read_text("utf-8").split("\n")[0].split(",")
    assert head[0] == "t [s]"
    assert head[1] == f"q.{arm.joint_names[0]} [rad]"
    assert head[-1] == f"a.{arm.joint_names[-1]} [rad/s²]"
    spline = Spline.from_csv(arm, tmp_path / "motion.csv")
    assert spline.duration == pytest.approx(motion.duration)
    for t in (0.4, 3.21, motion.duration - 0.5):
        q, v, a = motion(t)
        q_again, v_again, a_again = spline(t)
        np.testing.assert_allclose(arm.difference(q, q_again), 0.0, atol=1e-7)
        np.testing.assert_allclose(v_again, v, atol=1e-5)
        np.testing.assert_allclose(a_again, a, atol=2e-3)


def test_what_it_shows_is_told(motions):
    seen = {(item.body, item.parameter): item for item in motions["two_link"].seen}
    first, second = motions["two_link"].arm.joint_names
    assert seen[first, "Coulomb"].alone
    assert seen[second, "Coulomb"].well
    # It moves in the plane of x and z: what lies across it, and products of inertia, do nothing.
    for still in ("my", "Ixy", "Ixz", "Iyz", "Ixx"):
        assert not seen[first, still].acts
        assert not seen[second, still].acts
    assert seen[first, "armature"].share < 1.0


def test_an_arm_without_limits_of_effort_and_speed(monkeypatch):
    quick(monkeypatch)
    arm = fp.load_arm("two_link", effort_limit=np.inf, velocity_limit=np.inf)
    motion = Excitation(arm)
    _, v, _ = motion.joint_motion(np.linspace(0.0, 10.0, 500))
    assert np.abs(v).max() <= 0.8 * 2.0


def test_series_have_the_rest_that_they_promise():
    for harmonics in (2, 3, 9):
        series = RestingSeries(4.0, harmonics)
        assert series.free.shape == (2 * harmonics, 2 * (harmonics - 1))
        _, v, a = series.basis(np.array([0.0, 4.0]))
        np.testing.assert_allclose(v @ series.free, 0.0, atol=1e-12)
        np.testing.assert_allclose(a @ series.free, 0.0, atol=1e-10)


@pytest.mark.parametrize(
    ("asked", "named"),
    [
        ({"seed": -1}, "seed"),
        ({"period": 0.0}, "period"),
        ({"repetitions": 0}, "repetitions"),
        ({"harmonics": 1}, "harmonics"),
        ({"position_margin": 0.5}, "position_margin"),
        ({"velocity_share": 1.1}, "velocity_share"),
        ({"effort_share": 0.0}, "effort_share"),
        ({"acceleration_limit": -1.0}, "acceleration_limit"),
        ({"clearance": -0.01}, "clearance"),
        ({"floor": np.nan}, "floor"),
    ],
)
def test_what_cannot_be_is_named(asked, named):
    with pytest.raises(ArgumentError, match=named):
        Excitation(fp.load_arm("two_link"), **asked)


def test_limits_that_do_not_hold_the_arm_are_said():
    weak = fp.load_arm("two_link", effort_limit=0.5)
    with pytest.raises(ArgumentError, match="effort"):
        Excitation(weak)


def test_a_file_with_too_few_rows_is_refused(motions, tmp_path):
    with pytest.raises(ArgumentError, match="rate"):
        motions["two_link"].to_csv(tmp_path / "m.csv", rate=2.0)


@pytest.mark.long
@pytest.mark.parametrize("name", [*MOTIONS, *OTHERS])
@pytest.mark.parametrize("seed", [0, 1])
def test_every_arm_and_the_whole_search(name, seed):
    arm = fp.load_arm(name)
    started = time.process_time()
    motion = Excitation(arm, seed)
    assert time.process_time() - started < 60.0
    assert_bounds(motion)
    assert touches(motion, 4001) == []
