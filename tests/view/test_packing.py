"""Arrays survive packing bit by bit, and thinned curves keep their extremes."""

from __future__ import annotations

import base64
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from fotsmc_pin.view.curves import thinned_curves
from fotsmc_pin.view.pack import Pack


def unpacked(data: bytes, reference: dict) -> np.ndarray:
    """Undo the packing as the page does it."""
    kind, count = reference["kind"], reference["count"]
    width = int(kind[1])
    block = np.frombuffer(data, np.uint8, width * count, reference["at"])
    folded = np.ascontiguousarray(block.reshape(width, count).T).view(f"<u{width}").ravel()
    one = folded.dtype.type(1)
    steps = ((folded >> one) ^ (~(folded & one) + one)).astype(folded.dtype)
    return np.cumsum(steps, dtype=folded.dtype).view(f"<{kind}")


@given(
    hnp.arrays(np.float32, st.integers(0, 50), elements=st.floats(width=32)),
    hnp.arrays(np.uint16, st.integers(0, 50)),
    hnp.arrays(np.uint32, st.integers(0, 50)),
)
def test_every_bit_comes_back(floats, shorts, words):
    pack = Pack()
    arrays = {"f4": floats, "u2": shorts, "u4": words}
    references = {kind: pack.add(array, kind) for kind, array in arrays.items()}
    data = zlib.decompress(base64.b64decode(pack.text()))
    for kind, array in arrays.items():
        assert unpacked(data, references[kind]).tobytes() == array.tobytes()


def test_equal_arrays_are_stored_once():
    pack = Pack()
    first = pack.add(np.arange(1000.0))
    size = len(pack.text())
    assert pack.add(np.arange(1000.0)) == first
    assert len(pack.text()) == size


def test_smooth_columns_shrink():
    t = np.arange(10_000) * 1e-3
    pack = Pack()
    pack.add(np.sin(t))
    assert len(pack.text()) < 0.75 * 4 * len(t)


@given(
    count=st.integers(1, 400),
    limit=st.integers(4, 60),
    seed=st.integers(0, 2**32 - 1),
)
def test_thinned_curves_keep_extremes_ends_and_limit(count, limit, seed):
    rng = np.random.default_rng(seed)
    t, columns = np.sort(rng.uniform(size=count)), rng.normal(size=(count, 3))
    times, thin = thinned_curves(t, columns, limit)
    assert len(times) == len(thin) <= max(limit, 4)
    np.testing.assert_array_equal(thin.min(axis=0), columns.min(axis=0))
    np.testing.assert_array_equal(thin.max(axis=0), columns.max(axis=0))
    np.testing.assert_array_equal(thin[[0, -1]], columns[[0, -1]])
    assert (np.diff(times) >= 0).all()
    assert (times[0], times[-1]) == (t[0], t[-1])


def test_short_curves_come_back_untouched():
    t, columns = np.arange(10.0), np.ones((10, 2))
    times, thin = thinned_curves(t, columns, 10)
    assert times is t
    assert thin is columns


def test_chattering_keeps_its_height():
    t = np.arange(100_000) * 1e-3
    chatter = np.where(np.arange(len(t)) % 2, 1.0, -1.0)[:, None]
    _, thin = thinned_curves(t, chatter, 2000)
    assert thin.max() == 1.0
    assert thin.min() == -1.0
    assert (np.abs(thin) == 1.0).all()


@pytest.mark.parametrize("rate", [30.0, 60.0])
def test_frames_are_samples_of_the_recording(rate, two_link):
    from fotsmc_pin.view.motion import frame_rows

    rows = frame_rows(two_link.t, rate)
    assert (rows[0], rows[-1]) == (0, len(two_link.t) - 1)
    assert len(rows) == pytest.approx(rate * two_link.t[-1], rel=0.1)
