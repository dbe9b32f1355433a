"""A recording comes back from its file as it was, and no other file passes for one."""

import json

import numpy as np
import pytest

from fotsmc_pin.control import LinearSMC
from fotsmc_pin.errors import RecordingError
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import Recording, simulate


@pytest.fixture
def rec(arm):
    return simulate(arm, LinearSMC(arm, 1e-3), Sinusoid.inside_limits(arm), 0.02)


def assert_same(again, rec):
    for name in ("t", "q", "v", "q_d", "v_d", "e", "e_dot", "tau"):
        np.testing.assert_array_equal(getattr(again, name), getattr(rec, name))
    assert again.signals.keys() == rec.signals.keys()
    for name, signal in rec.signals.items():
        np.testing.assert_array_equal(again.signals[name], signal)
    assert again.arm == rec.arm
    assert again.metadata == rec.metadata


def test_a_recording_survives_its_file(rec, tmp_path):
    rec.save(tmp_path / "run.npz")
    assert_same(Recording.load(tmp_path / "run.npz"), rec)
    assert len(rec) == 21


def test_the_file_holds_no_pickle(rec, tmp_path):
    rec.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as file:
        assert all(file[name].dtype != object for name in file.files)


def test_metadata_tells_how_the_run_was_made(rec):
    about = rec.metadata
    assert about["controller"] == "LinearSMC"
    assert about["preset"] == "sign"
    assert about["gains"]["Lambda"] == 10.0
    assert about["dt"] == 1e-3
    assert about["duration"] == 0.02
    assert set(about["versions"]) >= {"python", "fotsmc_pin", "pin", "numpy", "numba"}


def test_the_error_is_the_tangent_from_the_reference(rec):
    for q_d, q, e in zip(rec.q_d, rec.q, rec.e, strict=True):
        np.testing.assert_allclose(e, rec.arm.difference(q_d, q), atol=1e-15)
    np.testing.assert_array_equal(rec.e_dot, rec.v - rec.v_d)
    np.testing.assert_allclose(rec.error_norm, np.linalg.norm(rec.e, axis=1))


def test_other_files_are_refused(tmp_path, rec):
    whole = tmp_path / "run.npz"
    rec.save(whole)
    foreign, cut, text = (tmp_path / name for name in ("foreign.npz", "cut.npz", "text.npz"))
    np.savez(foreign, t=np.arange(3))
    cut.write_bytes(whole.read_bytes()[:-200])
    text.write_text("no recording")
    for path in (foreign, cut, text):
        with pytest.raises(RecordingError, match=path.name):
            Recording.load(path)
    with pytest.raises(FileNotFoundError):
        Recording.load(tmp_path / "none.npz")


def in_format(number, path, names, **whole):
    """Write the recording at `path` as another format had it, with its `names` of the arrays.

    Formats 2 and 3 were compressed and held each of the arrays, `whole` among them.
    """
    with np.load(path) as file:
        arrays = {names.get(name, name): file[name] for name in file.files}
    header = json.loads(str(arrays["header"])) | {"format": number}
    if whole:
        del header["derived"]
    arrays |= {names.get(name, name): table for name, table in whole.items()}
    np.savez_compressed(path, **arrays | {"header": np.array(json.dumps(header))})


@pytest.mark.parametrize(("number", "names"), [(2, {"e_dot": "ed"}), (3, {})])
def test_a_recording_of_an_older_version_is_read(tmp_path, rec, number, names):
    path = tmp_path / "run.npz"
    rec.save(path)
    in_format(number, path, names, e=rec.e, e_dot=rec.e_dot)
    assert_same(Recording.load(path), rec)


def test_a_recording_of_a_newer_version_is_refused_by_number(tmp_path, rec):
    path = tmp_path / "run.npz"
    rec.save(path)
    in_format(99, path, {})
    with pytest.raises(RecordingError, match="format 99, this version reads 2, 3 and 4"):
        Recording.load(path)


def test_a_bent_byte_is_noticed_or_does_no_harm(tmp_path, rec):
    """The file's data carry checksums, parts of its frame (dates, say) do not."""
    whole, bent = tmp_path / "run.npz", tmp_path / "bent.npz"
    rec.save(whole)
    content = whole.read_bytes()
    directory = content.index(b"PK\x01\x02")
    noticed = 0
    for place in (*range(0, directory, 97), *range(directory, len(content))):
        bent.write_bytes(content[:place] + bytes([content[place] ^ 0xFF]) + content[place + 1 :])
        try:
            again = Recording.load(bent)
        except RecordingError as error:
            assert "bent.npz" in str(error)
            noticed += 1
        else:
            assert_same(again, rec)
    assert noticed > 100


def test_a_failed_save_leaves_the_old_file(tmp_path, rec):
    path = tmp_path / "run.npz"
    rec.save(path)
    before = path.read_bytes()
    rec.metadata["unsaved"] = object()
    with pytest.raises(TypeError):
        rec.save(path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["run.npz"]
