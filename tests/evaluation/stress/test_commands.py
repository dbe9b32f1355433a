"""`fotsmc stress` and `fotsmc tune`: a table in a file, not overwritten, gone on with."""

import json

import pytest
from typer.testing import CliRunner

from fotsmc_pin.arms.catalog import find_source
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError, OutputExistsError

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


def test_scenarios_are_columns_of_a_matrix(tmp_path):
    words = ["--controller", "RobustFONFTSM", "--scenario", "hold raw", "--scenario", "slow"]
    shown = called(*STRESS, str(tmp_path), *words)
    for title in ("tail RMS error [mrad]", "largest swing", "arrival time [s]", "without friction"):
        assert title in " ".join(shown.split())
    rows = json.loads((tmp_path / "stress.json").read_text())["rows"]
    labels = [(row["scenario"], row["variant"]) for row in rows]
    assert labels == [("hold", "raw"), ("slow", "2 ms"), ("slow", "4 ms")]
    assert "Ticks of 4 ms" in rows[2]["text"]
    written = (tmp_path / "stress.md").read_text()
    assert "| arm | controller | hold raw | slow 2 ms | slow 4 ms |" in written
    assert f"- asr_twodof, slow 4 ms: {rows[2]['text']}" in written


def test_an_unknown_scenario_is_refused_before_the_folder_is_made(tmp_path):
    with pytest.raises(ArgumentError, match="scenarios = 'holds'"):
        called(*STRESS, str(tmp_path / "out"), "--scenario", "holds")
    assert not (tmp_path / "out").exists()
    with pytest.raises(ArgumentError, match="--draws"):
        called("stress", "asr_twodof", "--scenario", "hold", "--draws", "1")


def test_what_an_ablation_does_not_heed_is_refused():
    for words in (["--jobs", "2"], ["--learn"]):
        with pytest.raises(ArgumentError, match=f"{words[0]} = .*leave it out with --ablation"):
            called("stress", "asr_twodof", "--ablation", *words)


def test_draws_are_spread_over_processes_and_are_the_same(tmp_path):
    written = []
    for jobs in ("1", "2"):
        out = tmp_path / jobs
        words = ["--draws", "3", "--duration", "0.2", "--jobs", jobs, "--out", str(out)]
        called("stress", "asr_twodof", *words)
        written.append((out / "stress.json").read_bytes())
    assert written[0] == written[1]


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


def test_tune_refuses_the_folder_of_another_arm_duration_or_seed(tmp_path):
    pytest.importorskip("optuna")
    out = ["--controller", "ComputedTorque", "--trials", "2", "--out", str(tmp_path / "out")]
    source = find_source("asr_twodof").path.read_text()
    arm = tmp_path / "own.urdf"
    arm.write_text(source)
    called("tune", str(arm), "--duration", "0.2", *out)
    front = (tmp_path / "out/front.md").read_bytes()
    for words, says in (
        (("two_link", "--duration", "0.2"), "its arm is .*, not two_link"),
        ((str(arm), "--duration", "0.3"), "duration .* is 0.2, not 0.3"),
        ((str(arm), "--duration", "0.2", "--seed", "1"), "its seed is 0, not 1"),
        ((str(arm), "--duration", "0.2", "--armature", "0.01"), "digest"),
    ):
        with pytest.raises(ArgumentError, match=says) as refused:
            called("tune", *words, *out)
        assert refused.value.argument == "--out"
    arm.write_text(source.replace('mass value="', 'mass value="1'))
    with pytest.raises(ArgumentError, match="digest"):
        called("tune", str(arm), "--duration", "0.2", *out)
    assert (tmp_path / "out/front.md").read_bytes() == front
