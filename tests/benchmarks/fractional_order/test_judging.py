"""The judging of the study of the order: fronts, hypervolumes and intervals of known answer."""

import lzma
import math

import numpy as np
import pytest

pytest.importorskip("optuna")

from tests.benchmarks.fractional_order import store
from tests.benchmarks.fractional_order.held_out import chosen
from tests.benchmarks.fractional_order.judging import (
    front,
    hypervolume,
    hypervolume_difference,
    paired_interval,
    pooled_interval,
)
from tests.benchmarks.fractional_order.runs import Outcome, lost
from tests.benchmarks.fractional_order.store import Search, Store, Trial

SEARCH = Search("the paper's case", "free", True, 2)


def test_a_front_keeps_what_nothing_dominates():
    points = np.array([[3.0, 1.0], [1.0, 3.0], [2.0, 2.0], [2.0, 2.0], [2.5, 2.5], [1.0, 4.0]])
    assert front(points).tolist() == [1, 2, 0]


def test_a_front_leaves_out_what_is_not_finite():
    points = np.array([[0.0, math.inf], [1.0, 1.0], [math.nan, 0.0]])
    assert front(points).tolist() == [1]


def test_the_hypervolume_of_steps():
    points = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0], [2.0, 2.0]])
    # Columns of width 1 under the reference point (3, 3): heights 1, 2 and 3.
    assert hypervolume(points, (3.0, 3.0)) == pytest.approx(6.0)


def test_points_beyond_the_reference_add_nothing():
    points = np.array([[1.0, 1.0], [-9.0, 5.0], [5.0, -9.0]])
    assert hypervolume(points, (2.0, 2.0)) == pytest.approx(1.0)


@pytest.mark.parametrize("spread", [0.1, 2.0])
def test_a_paired_interval_covers_the_mean_as_often_as_it_says(spread):
    rng = np.random.default_rng(3)
    covered = sum(
        not paired_interval(0.7 + spread * rng.standard_normal(8), draws=800).excludes(0.7)
        for _ in range(300)
    )
    # A percentile interval of 8 numbers covers a little less than 95 %.
    assert 0.88 <= covered / 300 <= 0.98


def test_what_two_have_in_common_does_not_widen_a_paired_interval():
    hardness = np.random.default_rng(0).standard_normal(8)
    found = paired_interval((5.0 * hardness + 0.3) - 5.0 * hardness)
    assert found.value == pytest.approx(0.3)
    assert found.high - found.low < 1e-9


def test_one_pair_tells_nothing():
    assert not paired_interval(np.array([3.0])).excludes(-1e9)


def test_groups_that_disagree_widen_the_pooled_interval():
    tight = 1e-3 * np.random.default_rng(0).standard_normal((6, 8))
    agreeing = pooled_interval([*tight])
    disagreeing = pooled_interval([row + shift for row, shift in zip(tight, range(6), strict=True)])
    assert agreeing.high - agreeing.low < 0.01
    assert disagreeing.value == pytest.approx(2.5, abs=0.01)
    assert disagreeing.low < 1.7 and disagreeing.high > 3.3


def test_the_hypervolume_of_a_front_that_is_shifted_by_a_known_amount():
    designs = np.array([[0.0, 1.0], [1.0, 0.0]])
    hardness = np.random.default_rng(0).standard_normal((1, 8, 1))
    others = designs[:, None, :] + 0.0 * hardness + np.zeros((2, 8, 2))
    better = others - np.array([0.5, 0.0])
    found = hypervolume_difference(better, others, draws=50)
    # The reference point is (1, 1), where the others dominate nothing.
    assert found.value == pytest.approx(0.5 * 1.0)
    assert found.low == pytest.approx(found.high)
    assert hypervolume_difference(others, better, draws=50).value == pytest.approx(-0.5)


def test_designs_are_chosen_by_the_search_alone_and_within_their_budgets():
    default = Outcome(1e-3, 100.0, 50.0, 0.5)
    outcomes = [
        default,
        Outcome(1e-4, 190.0, 49.0, 0.5),
        Outcome(1e-5, 390.0, 49.0, 0.5),
        Outcome(2e-3, 20.0, 29.0, 0.5),
        lost(),
    ]
    found = chosen([Trial({}, outcome) for outcome in outcomes], default)
    assert found["variation 0.25"] == found["variation 0.5"] == 3
    assert found["variation 1"] == 0
    assert found["variation 2"] == 1
    assert found["variation 4"] == 2
    # The loudest is quiet in peaks, but hums.
    assert found["peak 0.6"] == found["peak 0.8"] == 3
    assert found["peak 1.05"] == found["peak 1.5"] == 1


def test_a_budget_that_nothing_meets_has_no_design():
    default = Outcome(1e-3, 100.0, 50.0, 0.5)
    assert chosen([Trial({}, Outcome(1e-3, 1e3, 50.0, 0.5))], default) == {}


def test_what_is_stored_comes_back_though_a_line_was_cut_off(tmp_path):
    folder, gains = Store(tmp_path / "runs"), {"A": 28.0, "alpha": 0.3}
    folder.add_trial(SEARCH, 0, Trial(gains, Outcome(1e-3, 100.0, 50.5, 0.5)))
    file = tmp_path / f"runs/{SEARCH.file}.trials.csv"
    with file.open("a") as stream:
        stream.write("the paper's ca")
    assert folder.of(SEARCH).trials[SEARCH] == [Trial(gains, Outcome(1e-3, 100.0, 50.5, 0.5))]
    folder.add_trial(SEARCH, 1, Trial(gains, lost()))
    folder.add_held_out(SEARCH, 1, 3, Outcome(1e-6, 3.0, 2.0, 0.25))
    folder.pack(tmp_path / "archive")
    found = store.load(tmp_path / "archive")
    assert [trial.outcome.lost for trial in found.trials[SEARCH]] == [False, True]
    assert found.held_out[SEARCH] == {(1, 3): Outcome(1e-6, 3.0, 2.0, 0.25)}


def test_the_archive_names_its_columns(tmp_path):
    Store(tmp_path / "runs").pack(tmp_path)
    text = lzma.decompress((tmp_path / "trials.csv.xz").read_bytes()).decode()
    assert text.split(",")[:5] == ["problem", "configuration", "learning", "seed", "trial"]
    assert "peak torque [N·m]" in text


def _two_runs(folder, error=1e-3):
    made = Store(folder)
    made.add_trial(SEARCH, 0, Trial({"A": 28.0}, Outcome(error, 100.0, 50.5, 0.5)))
    made.add_held_out(SEARCH, 0, 3, Outcome(1e-6, 3.0, 2.0, 0.25))
    return made


def test_packing_keeps_what_the_archive_holds(tmp_path):
    _two_runs(tmp_path / "first").pack(tmp_path)
    second = Store(tmp_path / "second")
    second.add_trial(SEARCH._replace(seed=3), 0, Trial({"A": 5.0}, lost()))
    second.add_trial(SEARCH, 1, Trial({"A": 6.0}, lost()))
    second.pack(tmp_path)
    found = store.load(tmp_path)
    assert [trial.gains["A"] for trial in found.trials[SEARCH]] == [28.0, 6.0]
    assert [trial.gains["A"] for trial in found.trials[SEARCH._replace(seed=3)]] == [5.0]
    assert found.held_out[SEARCH] == {(0, 3): Outcome(1e-6, 3.0, 2.0, 0.25)}


def test_what_is_unpacked_packs_to_the_same_bytes(tmp_path):
    _two_runs(tmp_path / "first").pack(tmp_path)
    again, other = Store(tmp_path / "again"), tmp_path / "other"
    again.unpack(tmp_path)
    other.mkdir()
    again.pack(other)
    for kind in store.HEADS:
        name = f"{kind}.csv.xz"
        assert (other / name).read_bytes() == (tmp_path / name).read_bytes()
    with pytest.raises(FileExistsError, match="empty folder"):
        again.unpack(tmp_path)


def test_a_run_that_comes_out_otherwise_is_told_and_not_packed(tmp_path):
    _two_runs(tmp_path / "first").pack(tmp_path)
    before = (tmp_path / "trials.csv.xz").read_bytes()
    again = _two_runs(tmp_path / "again", error=2e-3)
    assert "1 runs in both, 0 the same" in again.against(tmp_path)
    with pytest.raises(RuntimeError, match="came out otherwise"):
        again.pack(tmp_path)
    assert (tmp_path / "trials.csv.xz").read_bytes() == before
