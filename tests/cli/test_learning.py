"""`--learn`: what simulate, stress and study do with it, keep and say."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import recorded_estimates

STUDY = """[study]
repeats = 2
[run]
arm = "two_link"
controller = "ComputedTorque"
duration = 0.3
{more}
"""


def called(*words):
    result = CliRunner().invoke(app, [*map(str, words)], env={"COLUMNS": "80"})
    if result.exception is not None:
        raise result.exception
    return result.output


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("learning") / "out"
    words = ["--mass-scale", "1.3", "--friction", "0.5", "--delay", "2", "--duration", "5"]
    said = called("simulate", "two_link", *words, "--learn", "--out", folder)
    return folder, said


def test_the_recording_is_of_a_law_that_learnt_with_the_stated_delay(made):
    rec = fp.Recording.load(made[0] / "run.npz")
    assert rec.metadata["controller"] == "RobustFONFTSM + learning"
    assert rec.metadata["learning"]["delay"] == 2


def test_the_table_says_what_is_known_and_what_is_not(made):
    folder, said = made
    assert "RobustFONFTSM + learning" in said
    assert "What was learnt, ± one standard deviation" in said
    rows = json.loads((folder / "estimates.json").read_text("utf-8"))["estimates"]
    known = [row["of"] for row in rows if row["known"] and row["group"] == "friction"]
    assert known == ["joint1", "joint2"]
    assert said.count("Coulomb friction") >= len(known)
    told = recorded_estimates(fp.Recording.load(folder / "run.npz"))
    assert [row["value"] for row in rows] == [row.value for row in told]
    written = (folder / "estimates.md").read_text("utf-8")
    assert "| Coulomb friction | joint1 |" in written
    missing = "The motion could not tell: "
    assert "mass and inertia of link2" in " ".join(said.split()).partition(missing)[2]
    assert "mass and inertia of link2" in written.partition(missing)[2]


def test_the_learnt_arm_is_an_arm_that_may_be_run(made):
    folder, said = made
    assert "learned.urdf" in said.replace("\n", "")
    arm = fp.load_arm(folder / "learned.urdf")
    rows = json.loads((folder / "estimates.json").read_text("utf-8"))["estimates"]
    friction = [row["value"] for row in rows if row["group"] == "friction"]
    assert arm.friction == pytest.approx(friction)
    assert (folder / "estimates.png").stat().st_size > 10_000


def test_without_it_nothing_of_the_kind_is_left(tmp_path):
    said = called("simulate", "two_link", "--duration", "0.1", "--out", tmp_path / "out")
    assert "learnt" not in said
    assert not [*(tmp_path / "out").glob("*estimates*"), *(tmp_path / "out").glob("learned*")]


def test_a_stress_table_says_that_the_laws_learn(tmp_path):
    words = ["--controller", "ComputedTorque", "--controller", "RobustFONFTSM", "--duration", "0.3"]
    said = called("stress", "asr_twodof", *words, "--learn", "--out", tmp_path)
    assert "+ learning" in said
    rows = json.loads((tmp_path / "stress.json").read_text())["rows"]
    assert [row["controller"] for row in rows] == [
        "ComputedTorque + learning",
        "RobustFONFTSM + learning",
    ]
    with pytest.raises(ArgumentError, match="--learn"):
        called("stress", "asr_twodof", "--ablation", "--learn")


def test_draws_are_of_the_laws_that_were_named(tmp_path):
    words = ["--draws", "1", "--duration", "0.3", "--first-seed", "4", "--out"]
    laws = ["--controller", "ComputedTorque", "--controller", "SuperTwistingSMC"]
    said = called("stress", "asr_twodof", *words, tmp_path / "named", *laws)
    rows = json.loads((tmp_path / "named/stress.json").read_text())["rows"]
    assert [row["controller"] for row in rows] == ["ComputedTorque", "SuperTwistingSMC"]
    assert said.count("The worst of 1 random scenarios") == 2
    called("stress", "asr_twodof", *words, tmp_path / "none", "--learn")
    (row,) = json.loads((tmp_path / "none/stress.json").read_text())["rows"]
    assert (row["controller"], row["seed"]) == ("RobustFONFTSM + learning", 4)


def test_a_study_learns_where_it_is_told_to(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.format(more=""))
    called("study", file, "--learn", "--jobs", "1", "--out", tmp_path / "out")
    rec = fp.Recording.load(tmp_path / "out/worst.npz")
    assert rec.metadata["controller"] == "ComputedTorque + learning"
    called("study", file, "--jobs", "1", "--out", tmp_path / "plain")
    rec = fp.Recording.load(tmp_path / "plain/worst.npz")
    assert rec.metadata["controller"] == "ComputedTorque"


def test_a_study_that_compares_learning_is_not_overruled(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.format(more="[grid]\nlearn = [false, true]"))
    with pytest.raises(ArgumentError, match=r"\[grid\] of the file says"):
        called("study", file, "--learn", "--jobs", "1", "--out", tmp_path / "out")
    called("study", file, "--jobs", "1", "--out", tmp_path / "out")
