"""`fotsmc reproduce`: a whole result, and verdicts that follow from its numbers alone."""

import json

import pytest

from fotsmc_pin.paper.claims import CLAIMS, judge
from fotsmc_pin.paper.contest import PEAK, contestants, cost, stored_gains
from fotsmc_pin.paper.reproduce import reproduce
from fotsmc_pin.paper.verdicts import as_markdown
from fotsmc_pin.simulation import Recording

FIGURES = (2, 3, 4, 5, 6, 7, 8, 9)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("two_link")
    fractions = []
    verdicts = reproduce(folder, fractions.append)
    return folder, verdicts, fractions


def test_every_file_is_there(result):
    folder, _, _ = result
    for number in FIGURES:
        assert list(folder.glob(f"figure_{number}_*.svg"))
        assert list(folder.glob(f"figure_{number}_*.png"))
    for name in ("run.npz", "metrics.json", "claims.md", "comparison.md", "two_link.html"):
        assert (folder / name).stat().st_size > 0
    assert not list(folder.glob(".*"))


def test_progress_ends_at_one_and_never_falls(result):
    _, _, fractions = result
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_verdicts_follow_from_the_metrics_file_alone(result):
    folder, verdicts, _ = result
    metrics = json.loads((folder / "metrics.json").read_text())
    assert judge(metrics) == verdicts
    assert (folder / "claims.md").read_text() == as_markdown(verdicts)
    assert len(verdicts) == len(CLAIMS)


def test_figure_4_is_said_plainly_to_chatter(result):
    folder, verdicts, _ = result
    metrics = json.loads((folder / "metrics.json").read_text())
    verdict = next(v for v in verdicts if "Fig. 4" in v.where)
    variation = metrics["runs"]["paper"]["tail_torque_variation"]
    layer = metrics["runs"]["boundary_layer"]["tail_torque_variation"]
    assert verdict.word == "no"
    assert f"{variation:.0f} N·m/s" in verdict.measured
    assert f"{layer:.0f} N·m/s" in verdict.why
    assert variation > 100 * layer


def test_a_run_without_chattering_would_be_believed(result):
    """The rule can come out the other way."""
    folder, _, _ = result
    metrics = json.loads((folder / "metrics.json").read_text())
    metrics["runs"]["paper"] = metrics["runs"]["boundary_layer"]
    verdict = next(v for v in judge(metrics) if "Fig. 4" in v.where)
    assert verdict.word == "yes"


def test_error_decays_like_the_power_that_theory_gives(result):
    """On S = 0 the error falls like t^-(1+α), α = 0.1, not in finite time."""
    folder, _, _ = result
    metrics = json.loads((folder / "metrics.json").read_text())
    assert metrics["runs"]["paper"]["tail_exponent"] == pytest.approx(-1.1, abs=0.15)


def test_settling_time_grows_with_the_order_and_peak_torque_falls(result):
    folder, _, _ = result
    runs = json.loads((folder / "metrics.json").read_text())["runs"]
    rows = [runs[name] for name in ("alpha_0.01", "paper", "alpha_0.3", "alpha_0.5", "alpha_0.9")]
    settling = [float(row["settling_time"]) for row in rows]
    torque = [row["peak_torque"] for row in rows]
    assert settling == sorted(settling)
    assert torque == sorted(torque, reverse=True)


def test_the_run_is_kept_whole(result):
    folder, _, _ = result
    rec = Recording.load(folder / "run.npz")
    assert rec.t[-1] == pytest.approx(10.0)
    assert rec.arm.name == "two_link_true"
    assert rec.metadata["controller"] == "AdaptiveFONFTSM"


def test_every_law_of_the_contest_was_tuned_within_the_same_limits(result):
    """The tuned gains are those of the search: same rule for all, and what they cost is stored."""
    folder, _, _ = result
    contest = json.loads((folder / "metrics.json").read_text())["contest"]
    assert {entry.key for entry in contestants()} == set(contest)
    for key, row in contest.items():
        entry = next(entry for entry in contestants() if entry.key == key)
        settings = {**entry.start, **row["gains"]}
        assert settings == row["gains"], f"{key}: an option of the match was dropped"


def test_a_stored_cost_comes_out_again():
    """What the store says of a law follows from running it, not from the file alone."""
    tuned = stored_gains()
    for law in ("RobustFONFTSM", "ComputedTorque"):
        entry = next(e for e in contestants() if e.law == law and e.match == PEAK)
        outcome = tuned[entry.key]
        assert cost(entry, outcome["gains"]) == pytest.approx(outcome["cost"], rel=0.05)
