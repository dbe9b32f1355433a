"""`fotsmc identify` and `fotsmc payload`: from a log to a URDF, a page and a table."""

import pytest
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError, LogError, OutputExistsError
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
    assert fp.load_arm(out).friction.min() > 0.0
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


def test_friction_that_was_identified_is_fed_forward(tmp_path):
    arm = fp.perturb(fp.load_arm("two_link"), friction=5.0)
    arm.write_urdf(tmp_path / "identified.urdf")
    run = ("simulate", tmp_path / "identified.urdf", "--controller", "ComputedTorque")
    errors = []
    for folder, more in (("without", ()), ("with", ("--feed-friction",))):
        said(*run, *more, "--duration", 3, "--out", tmp_path / folder)
        errors.append(fp.summarize(fp.Recording.load(tmp_path / folder / "run.npz")).rms_error)
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("two_link",), "states friction"),
        (("two_link", "--learn"), "--learn feeds"),
        (("two_link", "--controller", "TDEFONTSM"), "no model"),
    ],
)
def test_friction_that_nobody_states_or_uses_is_not_fed(words, reason, tmp_path):
    with pytest.raises(ArgumentError, match=reason):
        said("simulate", *words, "--feed-friction", "--out", tmp_path / "run")
