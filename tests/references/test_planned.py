"""Paths through waypoints: they meet them, keep the limits, and are what they say they are."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from fotsmc_pin.arms import load_arm
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import MinimumJerk, Quintic, Spline

PLANNERS = [Quintic, MinimumJerk]


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("name", ["panda", "kinova", "ur5"])
def test_paths_meet_their_waypoints(planner, name, waypoints):
    arm = load_arm(name)
    points = waypoints(arm, 5)
    path = planner.through(arm, points)
    for t, q in zip(path.breaks, points, strict=True):
        np.testing.assert_allclose(arm.difference(q, path(t)[0]), 0.0, atol=1e-9)
    for end in (0.0, path.duration):
        np.testing.assert_allclose(path(end)[1:], 0.0, atol=1e-8)


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("name", ["panda", "kinova"])
def test_derivatives_are_exact(planner, name, waypoints, assert_exact_derivatives):
    arm = load_arm(name)
    path = planner.through(arm, waypoints(arm, 4))
    times = np.linspace(0.01, 0.99, 23) * path.duration
    assert_exact_derivatives(arm, path, times, tolerance=1e-4)


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_shortest_times_touch_a_limit_and_break_none(planner, waypoints):
    arm = load_arm("panda")
    path = planner.through(arm, waypoints(arm, 4), acceleration_limit=5.0)
    samples = [path(t) for t in np.linspace(0, path.duration, 4000)]
    speed = np.abs([v for _, v, _ in samples]) / arm.velocity_limit
    acceleration = np.abs([a for _, _, a in samples]) / 5.0
    assert max(speed.max(), acceleration.max()) == pytest.approx(1.0, abs=1e-3)
    assert max(speed.max(), acceleration.max()) <= 1.0 + 1e-9


def test_quintics_rest_at_waypoints_and_minimum_jerk_passes(waypoints):
    arm = load_arm("panda")
    points = waypoints(arm, 3)
    stopping, passing = (planner.through(arm, points) for planner in PLANNERS)
    np.testing.assert_allclose(stopping(stopping.breaks[1])[1], 0.0, atol=1e-9)
    assert np.abs(passing(passing.breaks[1])[1]).max() > 0.05


def jerk_integral(path, steps=2000):
    t = np.linspace(0, path.duration, steps + 1)
    accelerations = np.array([path(moment)[2] for moment in t])
    jerk = np.diff(accelerations, axis=0) / np.diff(t)[:, np.newaxis]
    return float(np.sum(jerk**2) * path.duration / steps)


def test_minimum_jerk_has_least_jerk(waypoints):
    """Neither stops nor other speeds at the waypoint, at the same times, do with less."""
    arm = load_arm("ur5", keep="*pan*")
    points = waypoints(arm, 3)
    best = MinimumJerk.through(arm, points)
    least = jerk_integral(best)
    v = best(best.breaks[1])[1]
    for passing in (0.0 * v, 0.8 * v, v, 1.2 * v):
        velocities = [0.0 * v, passing, 0.0 * v]
        other = Quintic.through(
            arm, points, times=best.breaks, velocities=velocities, velocity_limit=100.0
        )
        assert jerk_integral(other) > 0.999 * least


def test_minimum_jerk_between_two_points_is_the_quintic(waypoints):
    arm = load_arm("panda")
    points = waypoints(arm, 2)
    one, two = (planner.through(arm, points, times=[0.0, 3.0]) for planner in PLANNERS)
    for t in np.linspace(0, 3, 17):
        for ours, theirs in zip(one(t), two(t), strict=True):
            np.testing.assert_allclose(ours, theirs, atol=1e-9)


def test_four_derivatives_of_minimum_jerk_are_continuous(waypoints):
    arm = load_arm("ur5")
    path = MinimumJerk.through(arm, waypoints(arm, 4))
    factorial = [1, 1, 2, 6, 24]
    for number, length in enumerate(np.diff(path.breaks)[:-1]):
        for order in range(5):
            powers = np.arange(5, -1, -1)
            weights = np.array(
                [
                    np.prod(np.arange(p, p - order, -1)) * length ** max(p - order, 0)
                    if p >= order
                    else 0.0
                    for p in powers
                ]
            )
            left = weights @ path.coefficients[:, number, :]
            right = factorial[order] * path.coefficients[5 - order, number + 1, :]
            scale = 1 + np.abs(right).max()
            np.testing.assert_allclose(left, right, atol=1e-6 * scale)


@pytest.mark.parametrize("planner", PLANNERS)
def test_too_little_time_says_which_limit_breaks(planner, waypoints):
    arm = load_arm("panda")
    with pytest.raises(ArgumentError, match=r"panda_joint\d would reach a velocity of .* limit"):
        planner.through(arm, waypoints(arm, 3), times=[0.0, 0.1, 0.2])
    with pytest.raises(ArgumentError, match="would reach an acceleration"):
        planner.through(arm, waypoints(arm, 3), times=[0.0, 5, 10], acceleration_limit=1e-3)


def test_a_waypoint_beyond_a_limit_is_named(waypoints):
    arm = load_arm("panda")
    points = waypoints(arm, 3)
    points[1, 3] = 1.0
    with pytest.raises(ArgumentError, match="panda_joint4 would reach a position of 1 rad"):
        Quintic.through(arm, points)


def test_continuous_joints_take_the_short_way():
    arm = load_arm("double_pendulum_continuous", velocity_limit=1.0)
    points = [arm.from_joint_positions([angle, 0.0]) for angle in (3.0, -3.0)]
    path = Quintic.through(arm, points)
    assert path.duration == pytest.approx(1.875 * (2 * np.pi - 6.0), rel=1e-9)


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize(
    ("points", "options", "word"),
    [
        ([[0.0, 0.0]], {}, "waypoints"),
        ([[0.0], [1.0]], {}, "waypoints"),
        ("road", {}, "waypoints"),
        ([[0.0, 0.0], [0.0, np.nan]], {}, "waypoints"),
        ([[0.0, 0.0], [0.0, 0.0]], {}, "waypoints"),
        ([[0.0, 0.0], [1.0, 0.0]], {"times": [0.0]}, "times"),
        ([[0.0, 0.0], [1.0, 0.0]], {"times": [0.0, 0.0]}, "times"),
        ([[0.0, 0.0], [1.0, 0.0]], {"velocity_limit": -1.0}, "velocity_limit"),
    ],
)
def test_bad_plans_are_refused(planner, points, options, word):
    with pytest.raises(ArgumentError, match=word):
        planner.through(load_arm("two_link"), points, **options)


def test_nothing_to_limit_the_speed_is_said():
    with pytest.raises(ArgumentError, match="nothing limits joint1"):
        Quintic.through(load_arm("double_pendulum"), [[0.0, 0.0], [1.0, 0.0]])


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize("name", ["panda", "kinova"])
def test_many_times_at_once_give_the_same_bits_as_one_by_one(planner, name, waypoints):
    arm = load_arm(name)
    path = planner.through(arm, waypoints(arm, 4))
    times = np.linspace(-0.2, path.duration + 0.2, 57)
    singly = [np.array(rows) for rows in zip(*(path(t) for t in times), strict=True)]
    for at_once, one_by_one in zip(path.at(times), singly, strict=True):
        np.testing.assert_array_equal(at_once, one_by_one)
    assert not path.at(times)[1][[0, -1]].any()


# Splines through samples


@pytest.mark.parametrize("samples", [4, 5, 6, 7, 40])
@pytest.mark.parametrize("rest", [False, True])
def test_a_spline_is_the_interpolating_b_spline(samples, rest):
    """Its pieces, evaluated by powers, against de Boor's recursion on the B-spline itself."""
    arm = load_arm("ur5")
    rng = np.random.default_rng(samples)
    t = np.cumsum(rng.uniform(0.7, 1.3, samples))
    x = rng.uniform(-0.1, 0.1, (samples, arm.nv))
    degree = 5 if samples >= 6 else 3
    still = [(order, np.zeros(arm.nv)) for order in range(1, (degree + 1) // 2)]
    ends = (still, still) if rest else None
    spline = make_interp_spline(t - t[0], x, k=degree, bc_type=ends)
    path = Spline.from_samples(arm, t, x, rest=rest)
    for moment in np.linspace(0.0, path.duration, 203):
        for order, value in enumerate(path(moment)):
            exact = spline(moment, nu=order)
            np.testing.assert_allclose(value, exact, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_a_spline_recovers_a_smooth_motion(name, waypoints, assert_exact_derivatives):
    arm = load_arm(name)
    truth = MinimumJerk.through(arm, waypoints(arm, 2), times=[0.0, 6.0])
    t = np.linspace(0, 6, 121)
    spline = Spline.from_samples(arm, t, [truth(moment)[0] for moment in t])
    for moment in np.linspace(0, 6, 61):
        q, v, a = spline(moment)
        q_true, v_true, a_true = truth(moment)
        np.testing.assert_allclose(arm.difference(q_true, q), 0.0, atol=1e-9)
        np.testing.assert_allclose(v, v_true, atol=1e-7)
        np.testing.assert_allclose(a, a_true, atol=1e-5)
    assert_exact_derivatives(arm, spline, np.linspace(0.1, 5.9, 11))


def test_a_spline_may_start_late_and_rest_at_its_ends():
    arm = load_arm("two_link")
    t = np.linspace(5.0, 7.0, 21)
    q = np.stack([np.sin(t), np.cos(t)], axis=1)
    spline = Spline.from_samples(arm, t, q, rest=True)
    assert spline.duration == pytest.approx(2.0)
    for end in (0.0, 2.0):
        np.testing.assert_allclose(spline(end)[1:], 0.0, atol=1e-9)
    q_late, v_late, _ = spline(9.0)
    np.testing.assert_allclose(q_late, q[-1])
    assert not v_late.any()


@pytest.mark.parametrize("header", [None, "joint2,t,force,joint1"])
def test_a_csv_file_is_a_trajectory(tmp_path, header):
    arm, t = load_arm("two_link"), np.linspace(0, 1, 11)
    one, two = np.sin(t), t**2
    columns = [t, one, two] if header is None else [two, t, 0 * t, one]
    path = tmp_path / "way.csv"
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=header or "", comments="")
    path.write_text(path.read_text().lstrip("\n"))
    spline = Spline.from_csv(arm, path)
    q, v, a = spline(0.5)
    np.testing.assert_allclose(q, [np.sin(0.5), 0.25], atol=1e-6)
    np.testing.assert_allclose(v, [np.cos(0.5), 1.0], atol=1e-5)
    np.testing.assert_allclose(a, [-np.sin(0.5), 2.0], atol=1e-3)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "q = "),
        ("t,joint1\n0,0\n", "no column 'joint2'"),
        ("0,0,0\n1,x,0\n", "row 2"),
        ("0,0,0\n1,0\n", "row 2"),
        ("t,joint1,joint2\n0,0,0\n1,nan,0\n", "finite"),
        ("0,0,0\n1,0,0\n1,0,0\n2,0,0\n", "after the one before"),
        ("0,0,0\n1,9,0\n2,0,0\n3,0,0\n", "beyond its limit"),
    ],
)
def test_bad_csv_files_are_refused(tmp_path, text, word):
    path = tmp_path / "way.csv"
    path.write_text(text)
    with pytest.raises(ArgumentError, match=word):
        Spline.from_csv(load_arm("two_link"), path)
