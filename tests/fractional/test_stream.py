"""A stream keeps its whole state in one array, and bad input leaves that alone."""

import copy
import io
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.fractional import (
    FractionalDerivative,
    FractionalIntegral,
    advance,
    commit,
    predict,
)

SCHEMES = ("linear", "quadratic", "grunwald-letnikov")
KINDS = (FractionalDerivative, FractionalIntegral)
every = pytest.mark.parametrize("scheme", SCHEMES)
both = pytest.mark.parametrize("kind", KINDS)


def noise(count, n=3, seed=0):
    return np.random.default_rng(seed).normal(size=(count, n))


def started(kind, scheme, n=3, samples=7, **more):
    stream = kind(order=0.4, dt=1e-3, scheme=scheme, **more).stream(n)
    stream.update_many(noise(samples, n), 1e-3 * np.linspace(0.7, 1.3, samples))
    return stream


@both
@every
@pytest.mark.parametrize("samples", [0, 1, 2, 3, 50])
def test_a_state_put_away_and_taken_up_goes_on_bit_for_bit(kind, scheme, samples):
    stream = started(kind, scheme, samples=samples)
    file = io.BytesIO()
    np.savez(file, **stream.to_arrays())
    file.seek(0)
    resumed = kind(order=0.4, dt=1e-3, scheme=scheme).stream(3)
    with np.load(file) as arrays:
        resumed.from_arrays(arrays)
    twins = [stream.copy(), resumed, copy.deepcopy(stream), pickle.loads(pickle.dumps(stream))]
    expected = stream.update_many(noise(20, seed=1))
    for twin in twins:
        np.testing.assert_array_equal(twin.update_many(noise(20, seed=1)), expected)


@both
@every
def test_copying_the_memory_back_undoes_updates(kind, scheme):
    stream = started(kind, scheme)
    saved = stream.memory.copy()
    first = stream.update_many(noise(5, seed=2))
    stream.memory[:] = saved
    np.testing.assert_array_equal(stream.update_many(noise(5, seed=2)), first)


@both
@every
def test_reset_is_a_fresh_start(kind, scheme):
    stream = started(kind, scheme)
    stream.reset()
    fresh = kind(order=0.4, dt=1e-3, scheme=scheme).stream(3)
    np.testing.assert_array_equal(
        stream.update_many(noise(9, seed=3)), fresh.update_many(noise(9, seed=3))
    )


@both
@every
@pytest.mark.parametrize("dt", [0.0, -1e-3, np.nan, np.inf, "soon"])
def test_a_bad_period_leaves_the_state_alone(kind, scheme, dt):
    stream = started(kind, scheme)
    before = stream.memory.copy()
    with pytest.raises(ArgumentError, match="dt"):
        stream.update([1.0, 2.0, 3.0], dt=dt)
    with pytest.raises(ArgumentError, match="dt"):
        stream.update_many(noise(2), dt=[1e-3, dt])
    np.testing.assert_array_equal(stream.memory, before)


@both
@pytest.mark.parametrize(
    "x", [[1.0, np.nan, 2.0], [1.0, 2.0, np.inf], [1.0, 2.0], 1.0, [[1.0, 2.0, 3.0]], "abc", None]
)
def test_a_bad_sample_leaves_the_state_alone(kind, x):
    stream = started(kind, "linear")
    before = stream.memory.copy()
    with pytest.raises(ArgumentError, match="x = "):
        stream.update(x)
    with pytest.raises(ArgumentError, match="samples"):
        stream.update_many([[1.0, np.nan, 2.0]])
    with pytest.raises(ArgumentError, match="samples"):
        stream.update_many([[1.0, 2.0]])
    np.testing.assert_array_equal(stream.memory, before)


def test_arrays_of_another_operator_are_refused():
    stream = started(FractionalDerivative, "linear")
    arrays = stream.to_arrays()
    for other in (
        FractionalDerivative(order=0.41, dt=1e-3).stream(3),
        FractionalIntegral(order=0.4, dt=1e-3).stream(3),
        FractionalDerivative(order=0.4, dt=2e-3).stream(3),
        FractionalDerivative(order=0.4, dt=1e-3, scheme="quadratic").stream(3),
        FractionalDerivative(order=0.4, dt=1e-3).stream(2),
    ):
        with pytest.raises(ArgumentError):
            other.from_arrays(arrays)
    with pytest.raises(ArgumentError, match="memory"):
        stream.from_arrays({"coefficients": arrays["coefficients"]})
    with pytest.raises(ArgumentError, match="finite"):
        stream.from_arrays({**arrays, "memory": np.full_like(stream.memory, np.nan)})


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        ("order", -0.1),
        ("order", 1.1),
        ("order", np.nan),
        ("dt", 0.0),
        ("dt", "fast"),
        ("tolerance", 1e-13),
        ("horizon", 1e-4),
        ("tempering", -1.0),
        ("scheme", "cubic"),
    ],
)
@both
def test_a_bad_description_names_its_argument(kind, argument, value):
    with pytest.raises(ArgumentError, match=argument):
        kind(**{"order": 0.5, "dt": 1e-3, argument: value})


@both
@every
def test_samples_of_any_kind_and_layout(kind, scheme):
    samples = noise(10)
    expected = kind(order=0.4, dt=1e-3, scheme=scheme).stream(3).update_many(samples)
    stream = kind(order=0.4, dt=1e-3, scheme=scheme).stream(3)
    wide = np.zeros((10, 6))
    wide[:, ::2] = samples
    for i, row in enumerate(wide):
        given = (row[::2], list(row[::2]), tuple(row[::2]))[i % 3]
        np.testing.assert_array_equal(stream.update(given), expected[i])


@both
@every
@pytest.mark.parametrize("dt", [1e-3, 1.2e-3])
def test_the_output_is_affine_in_the_newest_sample(kind, scheme, dt):
    for samples in (0, 1, 2, 3, 40):
        stream = started(kind, scheme, samples=samples)
        before = stream.memory.copy()
        history, y = np.empty(3), np.empty(3)
        gain = predict(stream.coefficients, stream.memory, dt, history)
        np.testing.assert_array_equal(stream.memory, before)
        for x in noise(3, seed=4):
            stream.memory[:] = before
            advance(stream.coefficients, stream.memory, x, dt, y)
            np.testing.assert_allclose(y, history + gain * x, rtol=1e-13, atol=1e-15)
        after = stream.memory.copy()
        stream.memory[:] = before
        commit(stream.coefficients, stream.memory, x, dt)
        np.testing.assert_array_equal(stream.memory, after)


@both
@every
def test_signals_do_not_mix(kind, scheme):
    samples = noise(30, n=7)
    together = kind(order=0.4, dt=1e-3, scheme=scheme).stream(7).update_many(samples)
    for j in range(7):
        alone = kind(order=0.4, dt=1e-3, scheme=scheme).stream(1).update_many(samples[:, [j]])
        np.testing.assert_array_equal(alone[:, 0], together[:, j])


@every
def test_a_signal_at_rest_has_no_derivative_at_all(scheme):
    stream = FractionalDerivative(order=0.4, dt=1e-3, scheme=scheme).stream(1)
    values = stream.update_many(np.full((500, 1), 1.7), 1e-3 * (1 + 0.3 * noise(500, 1)[:, 0] ** 2))
    np.testing.assert_allclose(values, 0.0, atol=1e-12)
    assert (stream.update_many(np.full((500, 1), 1.7)) == 0.0).all() or scheme == "quadratic"


@every
@pytest.mark.parametrize("dt", [1e-3, 1.1e-3])
def test_a_signal_at_rest_leaves_no_subnormal_numbers(scheme, dt):
    """Arithmetic with them is 40 times slower."""
    stream = started(FractionalDerivative, scheme, tempering=100.0)
    for _ in range(5):
        stream.update_many(np.zeros((2000, 3)), dt)
        size = np.abs(stream.memory)
        assert not ((size > 0) & (size < np.finfo(float).tiny)).any()


@both
@every
def test_memory_does_not_grow(kind, scheme):
    stream = started(kind, scheme)
    size = stream.memory.size
    stream.update_many(noise(20_000))
    assert stream.memory.size == size
    assert np.isfinite(stream.memory).all()


def test_plain_python_computes_the_same():
    program = (
        "import numpy as np\n"
        "from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral\n"
        "x = np.random.default_rng(5).normal(size=(12, 2)).cumsum(0)\n"
        "dt = 1e-3 * np.array([1, 1, .8, 1, 1.3, 1, 1, 1, .7, 1, 1, 1])\n"
        "for kind in FractionalDerivative, FractionalIntegral:\n"
        f"  for scheme in {SCHEMES!r}:\n"
        "    s = kind(order=.6, dt=1e-3, scheme=scheme, tempering=2.0, tolerance=1e-4).stream(2)\n"
        "    print(repr(s.update_many(x, dt).ravel().tolist()))\n"
    )
    runs = [
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "NUMBA_DISABLE_JIT": flag, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()
        for flag in ("0", "1")
    ]
    for compiled, plain in zip(*runs, strict=True):
        np.testing.assert_allclose(eval(plain), eval(compiled), rtol=1e-11, atol=1e-12)
