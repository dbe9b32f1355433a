"""`fotsmc identify` and `fotsmc payload`: from a log to a URDF, a page and a table."""

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import LogError, OutputExistsError
from tests.identification import hidden

FIGURE = "data:image/"


def said(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    if result.exception is not None:
        raise result.exception
    return " ".join(result.stdout.split())


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Return the folder of three logs of a hidden two-link arm, one with a payload."""
    folder = tmp_path_factory.mktemp("logs")
    arm = fp.load_arm("two_link")
    true = hidden.hidden_plant(arm, 6, payload=0.0)
    loaded = fp.perturb(true, payload=5.0)
    for name, plant, seed in (("log", true, 1), ("other", true, 2), ("loaded", loaded, 3)):
        motion = hidden.swings(arm, seed, duration=12.0)
        log = hidden.calculated(plant, motion, seed, duration=12.0, noise=5e-4)
        log.to_csv(folder / f"{name}.csv", arm)
    return folder


def test_a_log_becomes_a_urdf_and_a_page(logs, tmp_path):
    out = tmp_path / "identified.urdf"
    words = ("identify", logs / "log.csv", "--urdf", "two_link", "-o", out)
    text = said(*words, "--validate", logs / "other.csv")
    assert "other.csv, predicted" in text
    assert "armature [kg·m²]" in text
    page = (tmp_path / "identified.html").read_text("utf-8")
    for part in ("Base parameters", "Torque of other logs", "What could not be told", FIGURE):
        assert part in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    identified = fp.load_arm(out)
    assert identified.friction.min() > 0.0
    assert identified.friction_is_known
    with pytest.raises(OutputExistsError, match="--force"):
        said(*words)
    weighed = said("payload", logs / "loaded.csv", "--urdf", out, "-o", tmp_path / "loaded.urdf")
    mass = float(weighed.split("mass ")[1].split()[0])
    assert mass == pytest.approx(5.0, rel=0.05)


def test_a_wrong_log_leaves_nothing_behind(logs, tmp_path):
    out = tmp_path / "identified.urdf"
    gravity = ("--gravity", 9.81, 0, 0)
    with pytest.raises(LogError, match="gravity"):
        said("identify", logs / "log.csv", "--urdf", "two_link", "-o", out, *gravity)
    assert not [*tmp_path.iterdir()]
