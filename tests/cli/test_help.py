"""Help and mistakes: units are shown, the near word is named, and commands agree."""

import re

import pytest
import typer
from typer.testing import CliRunner

from fotsmc_pin.cli import app
from fotsmc_pin.cli.arm_options import ArmOptions
from fotsmc_pin.cli.plant_options import PlantOptions

GROUP = typer.main.get_command(app)
COMMANDS = sorted(GROUP.commands)
UNIT = re.compile(r"\[[^\]]*(?:rad|kg|N|\bm\b|\bs\b)[^\]]*\]")
TAKE_AN_ARM = ("simulate", "inspect", "perturb", "stress", "tune")


def shown_help(command, width):
    """The help without frames and line breaks."""
    result = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": str(width)})
    assert result.exit_code == 0
    return result.output


@pytest.mark.parametrize("command", COMMANDS)
def test_every_unit_in_a_help_text_is_shown(command):
    shown = shown_help(command, 200)
    for parameter in GROUP.commands[command].params:
        for unit in UNIT.findall((getattr(parameter, "help", "") or "").replace("\\[", "[")):
            assert unit in shown, (parameter.name, unit)


@pytest.mark.parametrize(
    ("command", "option", "unit"),
    [
        ("simulate", "--payload", "[kg]"),
        ("simulate", "--start-error", "[rad, m]"),
        ("simulate", "--duration", "[s]"),
        ("simulate", "--dt", "[s]"),
        ("simulate", "--friction", "[N·m, N]"),
        ("simulate", "--gravity", "[m/s²]"),
        ("simulate", "--noise", "[rad/s, m/s]"),
        ("perturb", "--com-shift", "[m]"),
        ("perturb", "--damping", "[N·m·s/rad, N·s/m]"),
        ("perturb", "--true-armature", "[kg·m², kg]"),
        ("stress", "--duration", "[s]"),
        ("tune", "--largest-torque", "[N·m]"),
    ],
)
def test_an_option_that_has_a_unit_says_it(command, option, unit):
    row = next(line for line in shown_help(command, 250).splitlines() if f" {option} " in line)
    assert unit in row


@pytest.mark.parametrize("command", COMMANDS)
def test_at_80_columns_nothing_is_cut(command):
    shown = shown_help(command, 80)
    assert "…" not in shown
    assert max(map(len, shown.splitlines())) <= 80
    words = re.sub(r"[│╭╮╰╯─\s]+", " ", shown)
    for parameter in GROUP.commands[command].params:
        for name in parameter.opts:
            assert name.lstrip("-") in words


@pytest.mark.parametrize("command", TAKE_AN_ARM)
def test_the_options_about_an_arm_are_the_same_everywhere(command):
    theirs = {p.name: p.help for p in GROUP.commands[command].params}
    reference = {p.name: p.help for p in GROUP.commands["inspect"].params}
    for name in ArmOptions.__dataclass_fields__:
        assert theirs[name] == reference[name]


def test_the_options_about_a_plant_are_the_same_everywhere():
    one, other = (
        {p.name: p.help for p in GROUP.commands[c].params} for c in ("simulate", "perturb")
    )
    for name in PlantOptions.__dataclass_fields__:
        assert one[name] == other[name]


def test_the_version_is_that_of_the_package(fotsmc):
    from importlib.metadata import version

    assert fotsmc("--version").stdout.strip() == f"fotsmc_pin {version('fotsmc_pin')}"


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (("simulat", "panda"), "Did you mean 'simulate'?"),
        (("simulate", "two_lnk"), "did you mean two_link?"),
        (("simulate", "two_link", "--controller", "robustFONTSM"), "did you mean RobustFONFTSM?"),
        (("tune", "two_link", "--controller", "LinerSMC"), "did you mean LinearSMC?"),
        (("tune", "two_link", "--objective", "tail_error"), "did you mean tail_rms_error?"),
        (("simulate", "two_link", "--controler", "FONFTSM"), "Did you mean --controller?"),
        (("simulate", "two_link", "--reference", "mov"), "did you mean move?"),
        (("simulate", "two_link", "--disturbance", "pus"), "did you mean push?"),
        (("simulate", "two_link", "--gain", "thetta=3"), "did you mean theta?"),
    ],
)
def test_a_wrong_word_is_answered_with_the_near_one_in_one_line(fotsmc, tmp_path, words, near):
    result = fotsmc(*words)
    assert result.returncode == 2
    assert near in result.stderr
    assert result.stderr.startswith("fotsmc: ")
    assert len(result.stderr.splitlines()) == 1
    assert not any(tmp_path.iterdir())


def test_an_error_speaks_of_the_option_as_it_is_typed(fotsmc):
    assert "--tool-frame = 'hand'" in fotsmc("inspect", "panda", "--tool-frame", "hand").stderr
    assert "--mass-scale" in fotsmc("simulate", "two_link", "--mass-scale", "-1").stderr
    assert "--payload = '-2'" in fotsmc("simulate", "two_link", "--payload", "-2").stderr


def test_the_shell_completes_arms_laws_and_references(fotsmc):
    def completed(typed):
        environment = {"_FOTSMC_COMPLETE": "complete_zsh", "_TYPER_COMPLETE_ARGS": typed}
        return fotsmc(**environment).stdout

    assert "two_link_true" in completed("fotsmc simulate two_l")
    assert "RobustFONFTSM" in completed("fotsmc simulate two_link --controller Rob")
    assert "hold" in completed("fotsmc simulate two_link --reference h")
    assert "--payload-frame" in completed("fotsmc perturb two_link --payl")


def test_a_terminal_of_ascii_gets_ascii(new_fotsmc):
    ascii_only = {"LC_ALL": "C", "PYTHONIOENCODING": "ascii"}
    for words in (
        ("inspect", "two_link", "--samples", "5"),
        ("simulate", "--help"),
        ("simulate", "two_link", "--duration", "0.2", "--mass-scale", "1.1"),
    ):
        result = new_fotsmc(*words, **ascii_only)
        assert result.returncode == 0, result.stderr
        assert result.stdout.isascii()
        assert "N*m" in result.stdout
