"""`fotsmc simulate --task`."""

import json

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError


def run(*arguments):
    result = CliRunner().invoke(app, ["simulate", *map(str, arguments)])
    if result.exception is not None:
        raise result.exception
    return result.stdout


def test_a_task_is_simulated_and_its_page_written(tmp_path):
    out = tmp_path / "run"
    options = ("--armature", "rotors", "--payload", "2", "--duration", "1.0")
    said = run("ur5", "--task", "line", *options, "--out", out)
    assert "tool turned off, last half" in said
    assert "settles to" not in said
    rec = fp.Recording.load(out / "run.npz")
    assert rec.metadata["task"]["frame"] == "tool0"
    assert rec.signals["pose_d"].shape == (len(rec), 7)
    metrics = json.loads((out / "metrics.json").read_text("utf-8"))
    assert metrics["tail_rms_tool_error"] < 2e-3
    page = next(out.glob("*.html")).read_text("utf-8")
    assert '"axes"' in page
    assert '"pose_error"' in page


@pytest.mark.parametrize(
    ("arm", "word", "said"), [("ur5", "dance", "--task"), ("two_link", "hold", "six joints")]
)
def test_what_cannot_be_done_is_said(tmp_path, arm, word, said):
    with pytest.raises(ArgumentError, match=said):
        run(arm, "--task", word, "--out", tmp_path / "a")
