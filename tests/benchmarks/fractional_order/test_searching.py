"""The searches of the study of the order: equal starts, settings that repeat, and going on."""

import dataclasses

import numpy as np
import pytest

pytest.importorskip("optuna")

import fotsmc_pin as fp
from fotsmc_pin.simulation import TickDelay
from tests.benchmarks.fractional_order import polishing, searching
from tests.benchmarks.fractional_order.configurations import CONFIGURATIONS, SHARED
from tests.benchmarks.fractional_order.runs import DrawnNoise, Outcome, lost, run
from tests.benchmarks.fractional_order.settings import (
    DT,
    PAPER,
    held_out_setting,
    nominal_arm,
    search_setting,
)
from tests.benchmarks.fractional_order.store import Search, Store, Trial

SEARCH = Search("two_link", "free", False, 5)


@pytest.fixture
def bowl(monkeypatch):
    """Runs that cost nothing; a third of them is lost. Returns how many there were."""
    calls = []

    def attempt(configuration, setting, gains, learning):
        calls.append(gains)
        if gains["alpha"] > 0.6:
            return lost()
        return Outcome(1.0 / gains["A"], gains["A"] * gains["observer"], gains["theta"], 0.5)

    monkeypatch.setattr(searching, "_try", attempt)
    monkeypatch.setattr(searching, "search_setting", lambda problem, seed: None)
    return calls


def test_a_search_that_was_stopped_goes_on_as_if_it_had_not_been(bowl, tmp_path):
    whole = searching.finish(SEARCH, Store(tmp_path / "whole"), trials=60)
    part = Store(tmp_path / "part")
    searching.finish(SEARCH, part, trials=33)
    bowl.clear()
    assert searching.finish(SEARCH, part, trials=60) == whole
    assert len(bowl) == 27


def test_a_store_of_another_search_is_refused(bowl, tmp_path):
    store = Store(tmp_path)
    for number, trial in enumerate(searching.finish(SEARCH, Store(tmp_path / "a"), trials=3)):
        store.add_trial(SEARCH._replace(seed=6), number, trial)
    with pytest.raises(RuntimeError, match="Name another folder"):
        searching.finish(SEARCH._replace(seed=6), store, trials=4)


def test_both_orders_start_from_the_same_gains():
    free, integer = (searching.first_generation(name, 3) for name in ("free", "integer"))
    assert len(free) == len(integer) == searching.POPULATION
    for one, other in zip(free, integer, strict=True):
        assert {name: one[name] for name in SHARED} == other
    assert free[0]["alpha"] == fp.RobustFONFTSM(nominal_arm("two_link"), DT).gains.alpha


def test_every_start_lies_in_its_space():
    for name, configuration in CONFIGURATIONS.items():
        for gains in searching.first_generation(name, 1):
            for gain, span in configuration.space.items():
                assert span.low <= gains[gain] <= span.high


def test_the_defaults_are_the_first_trial():
    arm = nominal_arm("two_link")
    ours = CONFIGURATIONS["free"].controller(arm, CONFIGURATIONS["free"].start, learning=False)
    theirs = fp.RobustFONFTSM(arm, DT)
    for name, value in theirs.gains.as_dict().items():
        np.testing.assert_allclose(getattr(ours.gains, name), value, err_msg=name)


def test_order_0_is_order_0_whatever_the_tempering():
    arm = nominal_arm("two_link")
    law = CONFIGURATIONS["integer"].controller(arm, CONFIGURATIONS["integer"].start, learning=False)
    assert law.gains.alpha == 0.0
    setting = dataclasses.replace(search_setting("two_link", 1), span=(0.05, 0.1))
    gains = law.gains.as_dict() | {"tempering": 3.0}
    assert run(setting, law) == run(setting, fp.RobustFONFTSM(arm, DT, **gains))


@pytest.mark.parametrize("problem", [PAPER, "two_link"])
def test_a_setting_repeats_and_no_other_is_the_same(problem):
    def trace(setting):
        return (*setting.q0, *np.concatenate(setting.reference(0.4)))

    assert trace(search_setting(problem, 2)) == trace(search_setting(problem, 2))
    settings = [search_setting(problem, 1), search_setting(problem, 2)]
    settings += [held_out_setting(problem, k) for k in range(3)]
    assert len({trace(setting) for setting in settings}) == 5
    assert len({setting.true.urdf for setting in settings}) == 5


def test_the_quick_parts_run_what_the_library_runs():
    setting = dataclasses.replace(search_setting("two_link", 1), span=(0.1, 0.2))
    law = fp.RobustFONFTSM(setting.nominal, DT)
    rec = fp.simulate(
        setting.true,
        law,
        setting.reference,
        0.2,
        q0=setting.q0,
        v0=np.zeros(2),
        sensor=DrawnNoise(setting),
        actuator=TickDelay(1),
        integrator="semi-implicit",
        substeps=2,
    )
    tail = rec.t > 0.1 - 1e-9
    ours = run(setting, law)
    assert ours.error == pytest.approx(np.sqrt(np.mean(rec.error_norm[tail] ** 2)), rel=1e-5)
    assert ours.peak == pytest.approx(np.abs(rec.tau).max(), rel=1e-5)


def test_polishing_lowers_the_error_within_the_budget_and_goes_on(monkeypatch, tmp_path):
    def bowl(setting, law):
        error = 1e-3 + abs(np.log(law.gains.theta[0] / 60.0)) + abs(np.log(law.gains.A[0] / 60.0))
        return Outcome(1e-3 * float(error), float(law.gains.theta[0]), 1.0, 0.5)

    setting = search_setting("two_link", 1)
    monkeypatch.setattr(polishing, "run", bowl)
    monkeypatch.setattr(polishing, "held_out_setting", lambda problem, number: setting)
    monkeypatch.setattr(polishing, "search_setting", lambda problem, seed: setting)
    start = CONFIGURATIONS["integer"].start
    first = Trial(start, Outcome(1e-3 * 1.8, 21.0, 1.0, 0.5))
    search, store = Search("two_link", "integer", False, 5), Store(tmp_path)
    default = Outcome(1.0, 50.0, 1.0, 0.5)
    polishing.polish(search, [first], default, store, more=8)
    polishing.polish(search, [first], default, store, more=30)
    kept = polishing.polished_search(search, "variation 1", wide=False)
    results = store.of(kept)
    trials = results.trials[kept]
    best = trials[polishing.best_within(trials, 50.0)].outcome
    assert len(trials) == 30
    # The bowl's bottom lies beyond the budget, at theta = 60.
    assert best.variation <= 50.0
    assert best.error < 0.8 * first.outcome.error
    assert polishing.best_within(trials, 50.0) in {number for number, _ in results.held_out[kept]}
