"""`ClosedLoop`, and a study from a TOML file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, StudyError
from fotsmc_pin.evaluation.studies import read_study

EXAMPLE = Path(__file__).parents[3] / "examples/panda_study.toml"


@pytest.fixture(scope="module")
def loop():
    return fp.ClosedLoop(arm="two_link", controller="ComputedTorque", duration=0.1)


def test_a_row_can_be_had_again_as_a_whole_run(loop):
    draws = {"mass_scale": fp.Uniform(0.5, 1.5), "start_error": [0.01, 0.02]}
    found = fp.study(loop, draws=draws, repeats=3, jobs=1)
    row = found.worst("rms_error")
    rec = loop.record(row.parameters, row.seed)
    assert fp.summarize(rec).as_dict() == row.metrics
    assert rec.error_norm[0] == pytest.approx(row.parameters["start_error"] * np.sqrt(2))


def test_parameters_take_the_place_of_fields_and_gains(loop):
    changed = loop.having({"gains.kp": 100.0, "duration": 0.2})
    assert (changed.gains, changed.duration) == ({"kp": 100.0}, 0.2)
    assert (loop.gains, loop.duration) == ({}, 0.1)
    assert changed.record({}, 0).metadata["gains"]["kp"] == 100.0


def test_a_perturbation_within_a_run_is_drawn_from_its_seed(loop):
    drawn = loop.having({"mass_scale": fp.Uniform(0.5, 2.0)})
    first, second = (drawn.record({}, seed).arm.urdf for seed in (1, 2))
    assert first != second
    assert drawn.record({}, 1).arm.urdf == first


def test_an_unknown_parameter_is_named_with_its_neighbour(loop):
    with pytest.raises(ArgumentError, match="did you mean payload"):
        loop({"paylod": 1.0}, 0)
    with pytest.raises(ArgumentError, match="controller"):
        fp.ClosedLoop(arm="two_link", controller="PID")


def test_whatever_changes_the_outcome_changes_the_identity(loop):
    same = fp.ClosedLoop(arm="two_link", controller="ComputedTorque", duration=0.1)
    assert same.identity == loop.identity
    others = [
        loop.having({"duration": 0.2}),
        loop.having({"gains.kp": 1.0}),
        loop.having({"payload": fp.Uniform(0.0, 1.0)}),
        loop.having({"arm": fp.load_arm("two_link")}),
        loop.having({"arm": fp.load_arm("two_link_true")}),
    ]
    assert len({loop.identity, *(other.identity for other in others)}) == 6


def test_an_edited_urdf_is_another_arm(tmp_path):
    file = tmp_path / "own.urdf"
    file.write_text(fp.load_arm("two_link").urdf)
    before = fp.ClosedLoop(arm=str(file)).identity
    file.write_text(fp.load_arm("two_link_true").urdf)
    assert fp.ClosedLoop(arm=str(file)).identity != before


def test_the_law_is_the_robust_one_where_none_is_named():
    assert fp.ClosedLoop(arm="two_link").controller == "RobustFONFTSM"


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        ({"grid": {"gains.kp": [100.0], "gains.kz": [1.0]}}, "kz"),
        ({"grid": {"gains.kp": [100.0, -1.0]}}, "kp"),
        ({"draws": {"gains.kd": fp.Uniform(-5.0, 5.0)}}, "kd"),
        ({"draws": {"masscale": fp.Uniform(0.9, 1.1)}}, "did you mean mass_scale"),
        ({"draws": {"mass_scale": fp.Uniform(-1.0, 1.1)}}, "mass_scale"),
        ({"draws": {"payload": [0.0, 1.0, -1.0]}}, "payload"),
        ({"grid": {"controller": ["ComputedTorque", "PID"]}}, "controller"),
        ({"grid": {"preset": ["pd", "best"]}}, "preset"),
        ({"grid": {"integrator": ["rk5"]}}, "integrator"),
        ({"grid": {"duration": [0.1, 0.0]}}, "duration"),
        ({"grid": {"friction": [{"nobody": 1.0}]}}, "nobody"),
    ],
)
def test_a_study_checks_every_name_and_value_before_its_first_run(loop, tmp_path, parameters, says):
    store = tmp_path / "study.sqlite"
    with pytest.raises(ArgumentError, match=says):
        fp.study(loop, jobs=1, store=store, **parameters)
    assert not store.exists()


def test_a_check_of_ones_own_is_asked_for_every_point_and_end():
    asked = []

    class Run:
        identity = "one's own"

        def check(self, parameters):
            asked.append(parameters)

        def __call__(self, parameters, seed):
            return {"x": parameters["x"]}

    draws = {"y": fp.Uniform(0.0, 1.0), "z": [5, 6, 7]}
    fp.study(Run(), grid={"x": [1, 2]}, draws=draws, repeats=2, jobs=1)
    assert {(p["x"], p["y"]) for p in asked} == {(x, y) for x in (1, 2) for y in (0.0, 1.0)}
    assert {p["z"] for p in asked} == {5, 6, 7}


def test_the_example_file_describes_a_thousand_panda_runs():
    run, arguments = read_study(EXAMPLE)
    assert (run.arm, run.duration) == ("panda", 3.0)
    assert arguments["repeats"] * len(arguments["grid"]["controller"]) == 1000
    assert arguments["draws"]["payload"] == fp.Uniform(0.0, 2.0)


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        ("repeats = [", StudyError, "TOML"),
        ("[runs]\narm = 'panda'", ArgumentError, "runs"),
        ("[study]\nrepeat = 3\n[run]\narm = 'panda'", ArgumentError, "repeat"),
        ("[run]\narms = 'panda'", ArgumentError, "arms"),
        ("[run]\npayload = 1.0", StudyError, "needs an arm"),
        ("[run]\narm = 'panda'\npayload = { low = 2, high = 1 }", ArgumentError, "high"),
    ],
)
def test_a_file_that_describes_no_study_is_refused(tmp_path, text, error, says):
    file = tmp_path / "study.toml"
    file.write_text(text)
    with pytest.raises(error, match=says):
        read_study(file)


@pytest.fixture(scope="module")
def wrong():
    return fp.ClosedLoop(
        arm="two_link", controller="ComputedTorque", duration=3.0, mass_scale=1.3, friction=1.0
    )


class TestLearning:
    def test_a_law_that_learns_errs_less(self, wrong):
        plain, learning = (wrong({"learn": learn}, 0) for learn in (False, True))
        assert learning.tail_rms_error < 0.5 * plain.tail_rms_error

    def test_it_stands_in_the_recording_and_in_the_identity(self, wrong):
        learning = wrong.having({"learn": True, "duration": 0.05, "gains.kp": 100.0})
        told = learning.record({}, 0).metadata
        assert told["controller"] == "ComputedTorque + learning"
        assert told["gains"]["kp"] == 100.0
        assert told["learning"]["delay"] == 0
        assert learning.identity != learning.having({"learn": False}).identity

    def test_what_the_loop_bears_is_that_of_the_gains(self, wrong):
        def bears(kd):
            loop = wrong.having({"learn": True, "duration": 0.05, "gains.kd": kd})
            return loop.record({}, 0).metadata["learning"]["bears"]

        law = fp.ComputedTorque(fp.load_arm("two_link"), 1e-3, kd=500.0)
        assert bears(500.0) == [*fp.ModelLearning(law, delay=0).bears]
        assert bears(10.0) != bears(500.0)

    def test_it_is_yes_or_no(self, wrong):
        with pytest.raises(ArgumentError, match="give true or false"):
            wrong.check({"learn": "yes"})
