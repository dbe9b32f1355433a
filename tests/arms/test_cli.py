"""The commands about arms say what they should and write what they promise."""

from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from fotsmc_pin.arms import load_arm
from fotsmc_pin.cli.arms import arms_command
from fotsmc_pin.cli.inspect import inspect_command
from fotsmc_pin.cli.perturb import perturb_command
from fotsmc_pin.errors import ArgumentError, OutputExistsError, UrdfError

HOSTILE = Path(__file__).parent / "hostile"


@pytest.fixture
def run(monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    app = typer.Typer()
    app.command("arms")(arms_command)
    app.command("inspect")(inspect_command)
    app.command("perturb")(perturb_command)

    def call(*words):
        result = CliRunner().invoke(app, [str(word) for word in words])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        assert result.exit_code == 0, result.output
        return result.output

    return call


def test_arms_lists_every_arm_with_its_numbers(run):
    output = run("arms")
    for word in ("two_link", "panda", "kinova", "panda_finger_joint1", "16.8", "effort, velocity"):
        assert word in output


def test_inspect_says_what_was_understood(run):
    output = run("inspect", "talos_arm", "--samples", "50")
    for word in ("arm_left_2_joint", "22.32 N·m", "Condition number", "Looks wrong", "locked"):
        assert word in output


def test_inspect_speaks_of_what_is_not_given(run):
    output = run("inspect", "double_pendulum_continuous")
    for word in ("endless", "not given", "4 position coordinates for 2 degrees of freedom"):
        assert word in output


def test_inspect_uses_newtons_for_slides(run, made):
    output = run("inspect", made.chain("prismatic", "revolute"), "--keep", "joint1")
    assert "-2 to 2 m" in output
    assert "40 N " in output


def test_perturb_writes_a_second_urdf(run, tmp_path):
    target = tmp_path / "true.urdf"
    output = run(
        *("perturb", "panda", "-o", target, "--mass-scale", "0.9:1.1", "--seed", "3"),
        *("--payload", "1.5", "--payload-frame", "panda_link7"),
        *("--friction", "panda_joint1=0.5", "--friction", "panda_joint[23]=0.1:0.2"),
    )
    assert "payload_1 of 1.5 kg at panda_link7" in output
    assert "drawn from seed 3" in output
    friction = load_arm(target).friction
    assert friction[0] == 0.5
    assert all(0.1 <= value <= 0.2 for value in friction[1:3])
    assert not friction[3:].any()


def test_perturb_overwrites_only_when_forced(run, tmp_path):
    target = tmp_path / "true.urdf"
    target.write_text("mine")
    with pytest.raises(OutputExistsError):
        run("perturb", "panda", "-o", target)
    assert target.read_text() == "mine"
    run("perturb", "panda", "-o", target, "--force")
    assert load_arm(target).nv == 7


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("panda", "--mass-scale", "heavy"), ArgumentError),
        (("panda", "--mass-scale", "1.1", "--mass-scale", "1.2"), ArgumentError),
        (("panda", "--payload", "2:1"), ArgumentError),
        (("panda", "--com-shift", "0.1"), ArgumentError),
        ((HOSTILE / "loop.urdf",), UrdfError),
    ],
)
def test_a_refused_perturb_leaves_nothing(run, tmp_path, words, error):
    with pytest.raises(error):
        run("perturb", *words, "-o", tmp_path / "true.urdf")
    assert list(tmp_path.iterdir()) == []
