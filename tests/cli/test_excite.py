"""`fotsmc excite` writes a motion that `fotsmc simulate` follows, and says what it shows."""

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError, OutputExistsError
from fotsmc_pin.references import Spline
from fotsmc_pin.references import excitation_design as design


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(design, "STARTS", 1)
    monkeypatch.setattr(design, "PENALTIES", ((30.0, 3), (3000.0, 6)))


def said(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    if result.exception is not None:
        raise result.exception
    return " ".join(result.stdout.split())


def test_it_leaves_a_motion_and_says_what_it_shows(tmp_path):
    path = tmp_path / "motion.csv"
    text = said("excite", "two_link", "-o", path, "--repetitions", 2, "--period", 5)
    assert "2 periods of 5 s" in text
    assert "Coulomb" in text
    assert "no collision shapes" in text
    assert Spline.from_csv(fp.load_arm("two_link"), path).duration == pytest.approx(10.0)
    with pytest.raises(OutputExistsError, match="--force"):
        said("excite", "two_link", "-o", path)


def test_a_run_along_the_motion_measures_torque(tmp_path):
    motion = tmp_path / "motion.csv"
    said("excite", "two_link", "-o", motion, "--repetitions", 1, "--period", 4)
    options = ("--encoder-bits", 20, "--torque-noise", 0.005, "--out", tmp_path / "run")
    said("simulate", "two_link", "--reference", motion, "--mass-scale", 1.2, *options)
    rec = fp.Recording.load(tmp_path / "run/run.npz")
    assert rec.t[-1] == pytest.approx(4.0)
    noise = (rec.tau_measured - rec.tau).std(axis=0) / rec.arm.effort_limit
    assert noise == pytest.approx([0.005, 0.005], rel=0.1)


def test_a_bad_option_is_named(tmp_path):
    with pytest.raises(ArgumentError, match="--effort-share"):
        said("excite", "two_link", "-o", tmp_path / "m.csv", "--effort-share", 2)
    assert not (tmp_path / "m.csv").exists()
