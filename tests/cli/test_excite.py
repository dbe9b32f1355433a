"""`fotsmc excite` writes a motion that `fotsmc simulate` follows, and says what it shows."""

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.cli.run_references import task
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


def test_a_run_follows_the_motion(tmp_path):
    said("excite", "two_link", "-o", tmp_path / "m.csv", "--repetitions", 1, "--period", 4)
    found = task(str(tmp_path / "m.csv"), fp.load_arm("two_link"))
    assert found.duration == pytest.approx(4.0)
    assert abs(found.reference(0.0)[1]).max() < 1e-3
    assert abs(found.reference(2.0)[1]).max() > 0.1


def test_a_bad_option_is_named(tmp_path):
    with pytest.raises(ArgumentError, match="--effort-share"):
        said("excite", "two_link", "-o", tmp_path / "m.csv", "--effort-share", 2)
    assert not (tmp_path / "m.csv").exists()
