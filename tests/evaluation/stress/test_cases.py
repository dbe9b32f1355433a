"""The matrix of scenarios: each plant is what its case says, and the text names its numbers."""

import math
from dataclasses import replace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import BandwidthWarning
from fotsmc_pin.control import RobustFONFTSM, TaskSpace
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.stress import SCENARIOS, Rest, chosen_cases, stress, stress_scenario
from fotsmc_pin.evaluation.stress.courses import lasting
from fotsmc_pin.evaluation.stress.judging import judge, run_row
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.evaluation.stress.plants import drive_size, with_rotors
from fotsmc_pin.evaluation.stress.springs import with_learning
from fotsmc_pin.references import broken_limits

CASES = {case.label: case for cases in SCENARIOS.values() for case in cases}
ARMS = ("panda", "two_link", "kinova")


def moving_mass(arm):
    return sum(inertia.mass for inertia in arm.model.inertias[1:])


@pytest.fixture(scope="module")
def panda():
    return fp.load_arm("panda")


class TestChoice:
    def test_a_scenario_stands_for_its_cases_and_a_label_for_one(self):
        chosen = [case.label for case in chosen_cases(["hold raw", "slow"])]
        assert chosen == ["hold raw", "slow 2 ms", "slow 4 ms"]
        assert [*chosen_cases("all")] == [*CASES.values()]
        assert len(chosen_cases(["slow", "slow 2 ms"])) == 2

    @pytest.mark.parametrize("wrong", ["sin", ["sine", "holds"], []])
    def test_an_unknown_scenario_is_named(self, wrong):
        with pytest.raises(ArgumentError, match="stribeck"):
            chosen_cases(wrong)

    def test_sine_hold_and_moves_are_in_both_worlds(self):
        for name in ("sine", "hold", "moves"):
            assert [case.variant for case in SCENARIOS[name]] == ["raw", "rotors"]


class TestPlants:
    def test_the_nominal_arm_is_that_of_the_rule(self, panda):
        by_rule = fp.load_arm("panda", armature="rotors")
        nominal = stress_scenario(panda, "delay").arm
        np.testing.assert_array_equal(nominal.armature, by_rule.armature)
        assert nominal.mass_matrix(panda.neutral) == pytest.approx(
            by_rule.mass_matrix(panda.neutral), abs=0.0
        )

    def test_no_rotors_in_the_raw_world(self, panda):
        for name in ("sine raw", "hold raw", "moves raw"):
            scenario = stress_scenario(panda, name)
            assert scenario.arm == panda
            assert not scenario.true.armature.any()

    @pytest.mark.parametrize(
        ("label", "divisor"),
        [("rotors 1/400", 400), ("rotors 1/100", 100), ("rotors 1/50", 50), ("sine rotors", 150)],
    )
    def test_true_rotors_are_the_effort_limit_over_the_number(self, panda, label, divisor):
        scenario = stress_scenario(panda, label)
        np.testing.assert_allclose(scenario.true.armature, panda.effort_limit / divisor)
        np.testing.assert_allclose(scenario.arm.armature, panda.effort_limit / 200)
        assert f"limit / {divisor}" in scenario.text

    def test_unknown_rotors_are_in_the_true_arm_alone(self, panda):
        scenario = stress_scenario(panda, "rotors 1/100 unknown")
        np.testing.assert_allclose(scenario.true.armature, panda.effort_limit / 100)
        assert scenario.arm == panda
        assert scenario.course.judged == (5.0, 12.0)
        assert "nominal armature as in the file: 0 kg·m²" in scenario.text

    def test_the_light_arm_lacks_the_tool_of_its_model(self, panda):
        scenario = stress_scenario(panda, "light")
        assert moving_mass(scenario.true) == pytest.approx(moving_mass(panda))
        assert moving_mass(scenario.arm) == pytest.approx(moving_mass(panda) + 3.0)
        assert scenario.arm.name == "panda"
        assert "3 kg" in scenario.text

    def test_stribeck(self, panda):
        scenario = stress_scenario(panda, "stribeck")
        np.testing.assert_allclose(scenario.true.stiction, 1.5)
        np.testing.assert_allclose(scenario.true.stribeck_velocity, 0.05)
        assert "1.5 times" in scenario.text
        assert "0.05 rad/s" in scenario.text

    @pytest.mark.parametrize("stiffness", [1000, 200, 100])
    @pytest.mark.parametrize("side", ["motor", "link"])
    def test_elastic(self, panda, stiffness, side):
        scenario = stress_scenario(panda, f"elastic {stiffness} {side}")
        np.testing.assert_allclose(scenario.true.joint_stiffness, stiffness * panda.effort_limit)
        spring, rotor = scenario.true.joint_stiffness, scenario.true.armature
        np.testing.assert_allclose(
            scenario.true.joint_damping, 0.04 * np.sqrt(spring * rotor), rtol=1e-6
        )
        assert scenario.encoder == side
        assert f"limit × {stiffness}/rad" in scenario.text
        assert f"{side} side" in scenario.text

    def test_slow_ticks_leave_the_plant_its_step(self, panda):
        for label, dt in (("slow 2 ms", 2e-3), ("slow 4 ms", 4e-3)):
            scenario = stress_scenario(panda, label)
            assert (scenario.dt, scenario.delay) == (dt, 1)
            assert scenario.dt / scenario.substeps == pytest.approx(5e-4)
            assert f"{1e3 * dt:g} ms" in scenario.text

    def test_delay_and_encoders(self, panda):
        assert stress_scenario(panda, "delay").delay == 2
        assert "2 ticks late" in stress_scenario(panda, "delay").text
        for bits in (17, 20):
            scenario = stress_scenario(panda, f"encoder {bits} bits")
            assert scenario.bits == bits
            assert scenario.position_noise == scenario.velocity_noise == 0.0
            q, v = scenario._sensor()(0.0, scenario.q0, np.ones(7))
            steps = q / (2 * np.pi / 2**bits)
            np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
            np.testing.assert_array_equal(v, 0.0)
            assert f"{bits} bits" in scenario.text

    def test_the_twin_of_a_hold_differs_in_friction_alone(self, panda):
        scenario = stress_scenario(panda, "hold rotors")
        assert not scenario.twin.true.friction.any()
        assert not scenario.twin.true.damping.any()
        assert scenario.true.friction.all()
        q, v = panda.neutral, np.ones(7)
        ours, other = (each.true.inverse_dynamics(q, v, v) for each in (scenario, scenario.twin))
        np.testing.assert_array_equal(ours, other)
        assert stress_scenario(panda, "delay").twin is None

    def test_an_arm_without_effort_limits_gets_drives_from_its_weight(self):
        arm = fp.load_arm("double_pendulum")
        assert np.isinf(arm.effort_limit).all()
        size = drive_size(arm)
        assert np.isfinite(size).all()
        rng = np.random.default_rng(5)
        heaviest = [np.abs(arm.gravity(arm.random_configuration(rng))) for _ in range(50)]
        assert (size > np.max(heaviest, axis=0)).all()
        np.testing.assert_allclose(with_rotors(arm).armature, size / 200, rtol=1e-6)
        scenario = stress_scenario(arm, "rotors 1/100")
        np.testing.assert_allclose(scenario.true.armature, size / 100, rtol=1e-5)
        assert "Where no limit is stated" in scenario.text
        assert not run_row(scenario, RobustFONFTSM(scenario.arm, 1e-3), "", 0.2).diverged

    def test_a_given_payload_is_carried(self, panda):
        scenario = stress_scenario(panda, "delay", payload=1.0)
        assert moving_mass(scenario.true) == pytest.approx(1.3 * moving_mass(panda) + 1.0)
        assert stress_payload(panda) == 3.0


@pytest.mark.parametrize("name", ARMS)
class TestCourses:
    def test_moves_stay_inside_the_limits_of_the_arm_that_moves(self, name):
        scenario = stress_scenario(fp.load_arm(name), "moves rotors")
        course = scenario.course
        assert not broken_limits(
            scenario.true, course.reference, duration=course.duration, effort_share=0.8
        )
        assert len(course.rests) == 3

    def test_the_reference_stands_still_where_the_course_says(self, name):
        arm = fp.load_arm(name)
        for label in ("hold raw", "moves raw", "delay"):
            course = stress_scenario(arm, label).course
            for rest in course.rests:
                first = course.reference(rest.start + 1e-9)[0]
                for t in np.linspace(rest.start + 1e-9, rest.end, 7):
                    q_d, v_d, a_d = course.reference(float(t))
                    assert np.abs(arm.difference(first, q_d)).max() < 1e-9
                    assert np.abs(v_d).max() < 1e-9
                    assert np.abs(a_d).max() < 1e-6

    def test_velocity_and_acceleration_are_derivatives(self, name):
        arm, h = fp.load_arm(name), 1e-5
        for label, times in (("delay", (1.0, 6.4, 7.7)), ("moves raw", (2.3, 6.5))):
            reference = stress_scenario(arm, label).reference
            for t in times:
                (before, v0, _), (_, v, a), (after, v1, _) = (
                    reference(t + step) for step in (-h, 0.0, h)
                )
                np.testing.assert_allclose(arm.difference(before, after) / (2 * h), v, atol=1e-7)
                np.testing.assert_allclose((v1 - v0) / (2 * h), a, atol=1e-6)

    def test_the_motion_before_the_halt_is_that_of_the_sinusoids(self, name):
        arm = fp.load_arm(name)
        times = np.linspace(0.0, 6.0, 13)
        one, two = (stress_scenario(arm, label).reference for label in ("delay", "sine rotors"))
        for ours, other in zip(one.at(times), two.at(times), strict=True):
            np.testing.assert_array_equal(ours, other)
        q_d = one.at(np.array([5.0, 7.0]))[0]
        np.testing.assert_array_equal(q_d[1], one(7.0)[0])

    def test_every_case_runs(self, name):
        arm = fp.load_arm(name)
        for label, case in CASES.items():
            if not case.suits(arm):
                assert case.course == "task"
                continue
            scenario = case.scenario_of(arm, duration=0.2)
            law = TaskSpace if case.course == "task" else RobustFONFTSM
            row = run_row(scenario, law(scenario.arm, scenario.dt), "law")
            assert (row.arm, row.label) == (name, label)
            assert math.isfinite(row.tail_rms_error), label
            assert row.text.startswith(("follow", "hold", "make", "move"))
            assert (row.swing is None) == (case.course in ("sine", "moves", "task")), label
            assert (row.tool_way_error is None) == (case.course != "task"), label
            assert (row.motor_rms_error is None) == (case.stiffness is None)
            assert (row.friction_ratio is None) == (not case.frictionless_twin)


class TestJudging:
    def test_a_course_says_where_a_run_is_judged(self, panda):
        scenario = CASES["hold raw"].scenario_of(panda, duration=0.5)
        rec = scenario.run(RobustFONFTSM(panda, 1e-3))
        e = np.zeros_like(rec.e)
        e[rec.t >= 0.25, 2] = 3e-3
        e[rec.t >= 0.4, 2] = 4e-3
        rec = replace(rec, e=e, v=np.zeros_like(rec.v))
        row = judge(rec, "panda", "law", scenario.course)
        assert row.largest_swing == row.swing[2] == pytest.approx(1e-3)
        assert row.max_tail_error == pytest.approx(4e-3)
        assert row.arrival_time == math.inf
        assert row.overshoot is None

    def test_overshoot_is_read_from_the_move_and_its_rest(self, panda):
        scenario = stress_scenario(panda, "moves raw")
        course = lasting(scenario.course, 3.5)
        rec = scenario.run(RobustFONFTSM(panda, 1e-3), 3.5)
        e = np.zeros_like(rec.e)
        late = rec.t > course.rests[0].start + 0.1
        direction = np.sign(panda.difference(rec.q_d[0], rec.q_d[-1]))
        e[late] = 2e-3 * direction
        rec = replace(rec, e=e, v=np.zeros_like(rec.v))
        assert judge(rec, "panda", "law", course).overshoot == pytest.approx(2e-3)
        rec = replace(rec, e=-e)
        assert judge(rec, "panda", "law", course).overshoot == pytest.approx(0.0, abs=1e-12)

    def test_springs_yield_to_gravity(self, panda):
        scenario = CASES["elastic 1000 motor"].scenario_of(panda, duration=2.0)
        row = run_row(scenario, RobustFONFTSM(scenario.arm, scenario.dt), "law")
        assert row.deflection == pytest.approx(row.static_deflection, rel=0.2)
        true = scenario.true
        q = scenario.reference(2.0)[0]
        static = np.linalg.norm(true.gravity(q) / true.joint_stiffness)
        assert row.static_deflection == pytest.approx(static, rel=0.2)

    def test_a_course_cut_short_keeps_the_rests_that_have_begun(self, panda):
        course = stress_scenario(panda, "moves raw").course
        first = course.rests[0]
        short = lasting(course, first.start + 1.0)
        assert short.rests == (Rest(first.start, first.start + 1.0, first.move_start),)
        assert short.judged[1] == short.duration == first.start + 1.0


def test_processes_give_the_same_rows():
    options = {"scenarios": ["sine", "delay"], "duration": 0.2}
    one = stress(["asr_twodof", "two_link"], ["LinearSMC"], **options)
    two = stress(["asr_twodof", "two_link"], ["LinearSMC"], **options, jobs=2)
    assert one == two
    assert [row.label for row in one[:3]] == ["sine raw", "sine rotors", "delay"]


def test_encoders_on_the_links_run_at_the_bandwidth_that_the_springs_bear():
    with pytest.warns(BandwidthWarning, match="link side"):
        (row,) = stress(["z1"], ["RobustFONFTSM"], scenarios="elastic 1000 link")
    assert row.bandwidth is not None
    assert 0.5 < row.bandwidth <= 1.0
    assert row.tail_rms_error < 0.03  # friction and payload, which such slow rates reject late
    assert row.largest_swing is not None
    assert row.largest_swing < 5e-3


def test_encoders_on_the_motors_are_observed_too():
    """The bare law rattles on a heavy arm's springs; run short, on the way to its reference."""
    (row,) = stress(["ur10"], ["RobustFONFTSM"], scenarios="elastic 1000 motor", duration=3.0)
    assert row.bandwidth == 1.0
    assert row.motor_rms_error is not None
    assert row.motor_rms_error < 1e-3
    assert row.deflection == pytest.approx(row.static_deflection, rel=0.2)


def test_learning_does_not_swing_what_springs_bear():
    """In the loop, the learnt inertia lost the arm: the bandwidth holds for the nominal one."""
    case = "elastic 1000 link"
    with pytest.warns(BandwidthWarning):
        (row,) = stress(["ur10"], ["RobustFONFTSM"], scenarios=case, learn=True, duration=6)
    assert not row.diverged
    assert row.tail_rms_error < 3.3e-3  # That of the same run without learning.


def test_learning_goes_inside_of_the_observer_of_springs():
    law = fp.RobustFONFTSM(fp.load_arm("two_link", armature=0.1), 1e-3)
    bare = with_learning(law, 2)
    assert isinstance(bare, fp.ModelLearning)
    observed = with_learning(fp.SpringObserver(law, 1e4, delay=2), 2)
    assert isinstance(observed, fp.SpringObserver)
    assert isinstance(observed.controller, fp.ModelLearning)
    assert (observed.delay, observed.controller.delay) == (2, 2)
