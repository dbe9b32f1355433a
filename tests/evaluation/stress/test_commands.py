"""`fotsmc stress` and `fotsmc tune`: a table in a file, not overwritten, gone on with."""

import json

import pytest
from typer.testing import CliRunner

from fotsmc_pin.cli import app
from fotsmc_pin.errors import OutputExistsError

STRESS = ["stress", "asr_twodof", "--duration", "0.3", "--out"]


def called(*words):
    result = CliRunner().invoke(app, [*words])
    if result.exception is not None:
        raise result.exception
    return result.output


def test_stress_writes_its_table(tmp_path):
    shown = called(*STRESS, str(tmp_path / "out"), "--controller", "RobustFONFTSM")
    for unit in ("[mrad]", "[s]", "[%]"):
        assert unit in shown
    assert "…" not in shown, "a narrow terminal cuts nothing"
    rows = json.loads((tmp_path / "out/stress.json").read_text())["rows"]
    assert [(row["arm"], row["controller"]) for row in rows] == [("asr_twodof", "RobustFONFTSM")]
    assert "| asr_twodof | RobustFONFTSM |" in (tmp_path / "out/stress.md").read_text()
    with pytest.raises(OutputExistsError, match="--force"):
        called(*STRESS, str(tmp_path / "out"))


def test_a_draw_is_replayed_by_its_seed(tmp_path):
    rows = []
    for folder in ("first", "again"):
        words = ["--draws", "1", "--first-seed", "3", "--out", str(tmp_path / folder)]
        called("stress", "asr_twodof", *words)
        rows.append((tmp_path / folder / "stress.json").read_text())
    assert rows[0] == rows[1]
    assert json.loads(rows[0])["rows"][0]["seed"] == 3


def test_tune_draws_the_front_and_goes_on(tmp_path):
    pytest.importorskip("optuna")
    words = ["tune", "asr_twodof", "--controller", "ComputedTorque", "--duration", "0.3"]
    for trials in ("3", "5"):
        shown = called(*words, "--trials", trials, "--out", str(tmp_path))
    assert "[rad]" in shown
    assert (tmp_path / "front.png").stat().st_size > 5000
    written = (tmp_path / "front.md").read_text()
    assert "kp=" in written
    assert "tail_rms_error [rad]" in written
