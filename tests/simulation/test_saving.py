"""Saving a long recording: fast, told as it goes, in little memory, and not a bit lost."""

import time
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import LinearSMC
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import Recording, simulate


@pytest.fixture(scope="module")
def rec(arms):
    arm = arms["panda"]
    return simulate(arm, LinearSMC(arm, 1e-3), Sinusoid.inside_limits(arm), 0.5)


def longer(rec, times):
    """Return the recording with its rows repeated, and the last bits of its numbers shuffled."""
    rng = np.random.default_rng(0)

    def tiled(table):
        rows = np.concatenate([table] * times)
        return rows * (1.0 + 1e-15 * rng.integers(-4, 5, rows.shape))

    names = ("q", "v", "q_d", "v_d", "tau")
    parts = {name: tiled(getattr(rec, name)) for name in names}
    signals = {name: tiled(table) for name, table in rec.signals.items()}
    t = np.arange(len(parts["q"])) * 1e-3
    e, e_dot = parts["q"] - parts["q_d"], parts["v"] - parts["v_d"]
    return replace(rec, t=t, e=e, e_dot=e_dot, signals=signals, **parts)


def bits(table):
    return np.ascontiguousarray(table).view(np.int64)


def test_errors_that_are_differences_are_not_stored_and_come_back_to_the_bit(rec, tmp_path):
    rec.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        assert {"e", "e_dot"}.isdisjoint(file.files)
        assert {"t", "q", "q_d", "tau"} <= set(file.files)
    again = Recording.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(bits(again.e), bits(rec.e))
    np.testing.assert_array_equal(bits(again.e_dot), bits(rec.e_dot))


@pytest.mark.parametrize("value", [-0.0, 1e-30, np.inf, np.nan])
def test_errors_that_are_no_differences_keep_their_bits(rec, tmp_path, value):
    e = np.array(rec.e)
    e[3, 1] = value
    replace(rec, e=e).save(tmp_path / "run.npz")
    np.testing.assert_array_equal(bits(Recording.load(tmp_path / "run.npz").e), bits(e))


def test_a_run_of_an_arm_with_continuous_joints_comes_back(tmp_path, arms):
    arm = arms["kinova"]
    run = simulate(arm, LinearSMC(arm, 1e-3), Sinusoid.inside_limits(arm), 0.02)
    run.save(tmp_path / "run.npz")
    np.testing.assert_array_equal(bits(Recording.load(tmp_path / "run.npz").e), bits(run.e))


def test_saving_tells_how_far_it_is(rec, tmp_path):
    told: list[float] = []
    longer(rec, 500).save(tmp_path / "run.npz", progress=told.append)
    assert len(told) > 10
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_saving_is_many_times_faster_than_deflating(rec, tmp_path):
    run = longer(rec, 500)
    started = time.perf_counter()
    run.save(tmp_path / "run.npz")
    saved = time.perf_counter() - started
    started = time.perf_counter()
    arrays = {name: getattr(run, name) for name in ("t", "q", "v", "q_d", "v_d", "e", "e_dot")}
    np.savez_compressed(tmp_path / "deflated.npz", tau=run.tau, **arrays, **run.signals)
    assert saved < 0.3 * (time.perf_counter() - started)


def test_the_same_recording_gives_the_same_bytes(rec, tmp_path):
    rec.save(tmp_path / "a.npz")
    rec.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_a_long_run_and_its_metrics_take_less_memory_than_twice_its_file(arms, tmp_path):
    arm = arms["two_link"]
    law = LinearSMC(arm, 1e-3)
    # What is compiled and imported is no part of the run.
    fp.summarize(simulate(arm, law, Sinusoid.inside_limits(arm), 0.01))
    tracemalloc.start()
    try:
        run = simulate(arm, law, Sinusoid.inside_limits(arm), 40.0)
        run.save(tmp_path / "run.npz")
        fp.summarize(run)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2.0 * (tmp_path / "run.npz").stat().st_size
