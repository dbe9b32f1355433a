"""`fotsmc simulate --task`."""

import json

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app


def test_a_task_is_simulated_and_its_page_written(tmp_path):
    out = tmp_path / "run"
    arguments = ["simulate", "ur5", "--task", "line", "--payload", "2", "--out", str(out)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    rec = fp.Recording.load(out / "run.npz")
    assert rec.metadata["task"]["frame"] == "tool0"
    assert rec.signals["pose_d"].shape == (len(rec), 7)
    metrics = json.loads((out / "metrics.json").read_text())
    assert metrics["tail_rms_tool_error"] < 1e-3


@pytest.mark.parametrize(("arm", "word"), [("ur5", "dance"), ("two_link", "hold")])
def test_what_cannot_be_done_is_said_in_one_line(tmp_path, arm, word):
    result = CliRunner().invoke(
        app, ["simulate", arm, "--task", word, "--out", str(tmp_path / "a")]
    )
    assert result.exit_code == 2
    assert "--task" in result.output or "six joints" in result.output
