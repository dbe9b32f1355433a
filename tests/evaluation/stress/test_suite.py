"""The stress suite: the scenario is what it says, and the law passes it untuned."""

import math
from dataclasses import replace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import ComputedTorque, GravityWarning, RobustFONFTSM
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.stress import (
    VARIANTS,
    ablate,
    best_pid,
    markdown,
    random_scenario,
    random_scenarios,
    run_random_scenarios,
    springs,
    stress,
    stress_scenario,
    suite,
)
from fotsmc_pin.evaluation.stress.judging import StressRow, run_row
from fotsmc_pin.evaluation.stress.scenario import DT
from fotsmc_pin.evaluation.stress.table import matrices, turned


class Pusher:
    """Drives every joint as hard as it can, always the same way."""

    dt = DT

    def __init__(self, arm):
        self.effort = arm.effort_limit

    def update(self, *_):
        return self.effort

    def reset(self):
        pass


class TestScenario:
    def test_the_plant_is_heavier_and_rubs(self):
        arm = fp.load_arm("panda")
        scenario = stress_scenario(arm)
        masses = [sum(i.mass for i in each.model.inertias[1:]) for each in (arm, scenario.true)]
        assert masses[1] == pytest.approx(1.3 * masses[0] + 3.0)
        # The wrist's limit is 12 N·m, below 20.
        np.testing.assert_allclose(scenario.true.friction, [0.5] * 4 + [0.3] * 3)
        np.testing.assert_allclose(scenario.true.damping, [0.5] * 4 + [0.3] * 3)
        start = arm.difference(scenario.reference(0.0)[0], scenario.q0)
        np.testing.assert_allclose(start, 0.2, atol=1e-12)

    def test_an_arm_without_a_rating_carries_a_tenth_of_its_mass(self):
        arm = fp.load_arm("two_link")
        scenario = stress_scenario(arm)
        masses = [sum(i.mass for i in each.model.inertias[1:]) for each in (arm, scenario.true)]
        assert masses[1] == pytest.approx(1.4 * masses[0])

    def test_one_seed_gives_one_run(self):
        scenario = stress_scenario(fp.load_arm("two_link"), seed=3)
        runs = [scenario.run(RobustFONFTSM(scenario.arm, DT), 0.3) for _ in range(2)]
        np.testing.assert_array_equal(runs[0].tau, runs[1].tau)
        other = stress_scenario(fp.load_arm("two_link"), seed=4)
        assert (other.run(RobustFONFTSM(scenario.arm, DT), 0.3).tau != runs[0].tau).any()

    def test_an_arm_that_cannot_hold_itself_warns_before_the_run(self):
        with pytest.warns(GravityWarning, match="talos_arm: gravity exceeds"):
            stress_scenario(fp.load_arm("talos_arm"))


@pytest.mark.parametrize(
    ("name", "tail"),
    [("panda", 1e-3), ("ur10", 2e-3), ("kinova", 2e-3), ("so100", 2e-3), ("two_link", 1e-4)],
)
def test_robust_fonftsm_passes_untuned(name, tail):
    (row,) = stress([name], ["RobustFONFTSM"])
    assert not row.diverged
    assert row.tail_rms_error <= tail
    assert row.settling_time < 3.0


class TestStress:
    def test_own_makers_are_run_by_their_labels(self):
        makers = {"stiff": lambda arm, dt: ComputedTorque(arm, dt, kp=2500.0, kd=100.0)}
        (row,) = stress([fp.load_arm("asr_twodof")], makers, duration=0.5)
        assert (row.arm, row.controller) == ("asr_twodof", "stiff")
        assert "| asr_twodof | stiff |" in markdown([row])

    def test_an_unknown_law_is_named(self):
        with pytest.raises(ArgumentError, match="RobustFONFTSM"):
            stress(["two_link"], ["RobustFONTSM"])

    def test_a_divergence_is_a_row(self):
        scenario = stress_scenario(fp.load_arm("so100"))
        row = run_row(scenario, Pusher(scenario.arm), "pusher", 2.0)
        assert row.diverged
        assert "| yes |" in markdown([row])


def test_the_search_is_never_worse_than_where_it_starts():
    pytest.importorskip("optuna")
    scenario = stress_scenario(fp.load_arm("asr_twodof"))
    preset = ComputedTorque(scenario.arm, DT, preset="pid")
    start = run_row(scenario, preset, "start", 1.0)
    row, gains = best_pid(scenario, trials=6, duration=1.0)
    assert row.tail_rms_error <= start.tail_rms_error
    again = run_row(scenario, ComputedTorque(scenario.arm, DT, **gains), row.controller, 1.0)
    assert again == row


def test_the_ablation_switches_one_ingredient_off_at_a_time():
    arm, seen = fp.load_arm("two_link"), []
    full = RobustFONFTSM(arm, DT).gains.as_dict()

    def note(law, label):
        gains = law.gains.as_dict()
        seen.append({name for name, value in gains.items() if value != full[name]})
        return StressRow(arm=arm.name, controller=label)

    assert [row.controller for row in ablate(note, arm, DT)] == [*VARIANTS]
    assert seen[0] == set()
    assert all(len(changed) == 1 for changed in seen[1:])


class TestMatrix:
    ROWS = (
        StressRow(arm="a", controller="x", tail_rms_error=1e-3, diverged=False),
        StressRow(arm="a", controller="x", scenario="slow", variant="2 ms"),
        StressRow(
            arm="b",
            controller="x",
            scenario="hold",
            tail_rms_error=2e-3,
            swing=(1e-3, 4e-3),
            arrival_time=math.inf,
            rest_torque_variation=3.0,
            variation_without_friction=2.0,
            diverged=False,
        ),
    )

    def test_a_line_per_arm_and_a_column_per_case(self):
        tables = matrices(self.ROWS)
        lines = tables["tail RMS error [mrad]"]
        assert lines[0] == ["arm", "controller", "sine raw", "slow 2 ms", "hold raw"]
        assert lines[1:] == [["a", "x", "1", "lost", "–"], ["b", "x", "–", "–", "2"]]
        swings = tables["largest swing of a joint at rest [mrad]"]
        assert swings[0][2:] == ["hold raw"]
        assert swings[2] == ["b", "x", "4"]
        assert tables["arrival time [s]"][2][2] == "never"
        ratios = tables["torque variation at rest over that without friction"]
        assert ratios[2][2] == "1.5"
        assert "overshoot [mrad]" not in tables

    def test_turned_it_has_a_line_per_case(self):
        lines = turned(matrices(self.ROWS)["tail RMS error [mrad]"])
        assert lines[0] == ["scenario", "a", "b"]
        assert lines[2] == ["slow 2 ms", "lost", "–"]

    def test_markdown_shows_each_metric_that_there_is(self):
        text = markdown(self.ROWS)
        assert text.count("## ") == 4
        assert "| a | x | 1 | lost | – |" in text

    def test_against_a_twin_that_was_lost_there_is_no_ratio(self):
        assert replace(self.ROWS[2], variation_without_friction=None).friction_ratio is None


class TestRandomScenarios:
    def test_every_number_lies_in_its_range(self):
        arm = fp.load_arm("panda")
        drawn = [random_scenario(arm, seed) for seed in range(12)]
        assert {scenario.name for scenario in drawn} == {"sine", "moves", "hold"}
        for scenario in drawn:
            np.testing.assert_allclose(scenario.arm.armature, arm.effort_limit / 200)
            divisors = arm.effort_limit / scenario.true.armature
            assert (divisors > 49.9).all()
            assert (divisors < 800.1).all()
            assert np.ptp(divisors) > 0.0
            assert (scenario.true.stiction >= 1.0).all()
            assert (scenario.true.stiction <= 1.5).all()
            assert scenario.course.judged == (2.0, 4.0)

    def test_a_seed_gives_its_scenario_again(self):
        arm = fp.load_arm("panda")
        first, second = random_scenario(arm, 5), random_scenario(arm, 5)
        assert first.true == second.true
        assert (first.delay, first.position_noise) == (second.delay, second.position_noise)
        np.testing.assert_array_equal(first.q0, second.q0)
        assert random_scenario(arm, 6).true != first.true

    def test_the_worst_comes_first_and_can_be_run_alone(self):
        arm = fp.load_arm("panda")
        done = run_random_scenarios(arm, 4, duration=1.0)
        tails = [found.row.tail_rms_error for found in done]
        assert tails == sorted(tails, reverse=True)
        assert not any(found.row.diverged for found in done)
        alone = run_random_scenarios(arm, 1, first_seed=done[0].seed, duration=1.0)
        assert alone == done[:1]

    def test_processes_share_the_seeds_and_give_the_same_rows(self, monkeypatch):
        shares = []

        def noted(parts, jobs):
            shares.extend((jobs, [*part.seeds]) for part in parts)
            return suite.carried_out(parts, jobs)

        monkeypatch.setattr(random_scenarios, "carried_out", noted)
        arm = fp.load_arm("asr_twodof")
        options = {"first_seed": 7, "duration": 0.2}
        together = run_random_scenarios(arm, 3, **options, jobs=2)
        assert shares == [(2, [7, 8]), (2, [9])]
        assert together == run_random_scenarios(arm, 3, **options)


class TestLearning:
    def test_every_law_learns_and_is_called_so(self):
        laws = ["ComputedTorque", "RobustFONFTSM"]
        rows = stress(["asr_twodof"], laws, duration=0.3, learn=True)
        assert [row.controller for row in rows] == [f"{law} + learning" for law in laws]

    def test_the_delay_of_the_case_is_known_to_it(self, monkeypatch):
        told = []

        class Noted(springs.ModelLearning):
            def __init__(self, controller, **options):
                told.append(options["delay"])
                super().__init__(controller, **options)

        monkeypatch.setattr(springs, "ModelLearning", Noted)
        cases = ["delay", "sine raw"]
        rows = stress(["asr_twodof"], ["ComputedTorque"], scenarios=cases, duration=0.1, learn=True)
        by_hand = [case.delay for case in suite.chosen_cases(cases)]
        assert len(set(by_hand)) > 1
        assert told == by_hand
        assert len(rows) == len(by_hand)

    def test_it_learns_the_plant_of_the_suite(self):
        plain, learning = (
            stress(["asr_twodof"], ["RobustFONFTSM"], learn=learn)[0] for learn in (False, True)
        )
        assert learning.tail_rms_error < 0.5 * plain.tail_rms_error

    def test_each_random_scenario_begins_anew(self):
        arm = fp.load_arm("asr_twodof")
        both = run_random_scenarios(arm, 3, duration=0.3, learn=True)
        for found in both:
            (alone,) = run_random_scenarios(arm, 1, first_seed=found.seed, duration=0.3, learn=True)
            assert alone == found

    def test_a_law_is_drawn_with_its_preset_for_practice(self):
        arm = fp.load_arm("asr_twodof")
        (found,) = run_random_scenarios(arm, 1, law="ComputedTorque", duration=0.3)
        scenario = random_scenario(arm, 0, duration=0.3)
        law = suite.law_maker(ComputedTorque)(scenario.arm, DT)
        assert law.preset == "pid"
        assert run_row(scenario, law, "ComputedTorque") == found.row
