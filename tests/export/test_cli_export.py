"""`fotsmc export` writes what `fp.export_c` does."""

from typer.testing import CliRunner

from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError


def test_the_command_writes_a_guarded_law(tmp_path):
    options = ("--controller", "ComputedTorque", "--gain", "kp=225", "--safeguard", "--float")
    done = CliRunner().invoke(app, ["export", "two_link", *options, "-o", str(tmp_path / "ctrl")])
    assert done.exit_code == 0, done.output
    header = (tmp_path / "ctrl" / "fotsmc_two_link.h").read_text("utf-8")
    source = (tmp_path / "ctrl" / "fotsmc_two_link.c").read_text("utf-8")
    assert "float torque_rate[2];" in header
    assert "state->gains.kp[0] = 225.0f;" in source


def test_what_the_drives_add_needs_a_safeguard(tmp_path):
    add = ("--compensates", "gravity,friction", "-o")
    done = CliRunner().invoke(app, ["export", "two_link", *add, str(tmp_path / "bare")])
    assert "give --safeguard too" in str(done.exception)
    guarded = ["export", "two_link", "--controller", "ComputedTorque", "--safeguard", *add]
    done = CliRunner().invoke(app, [*guarded, str(tmp_path / "ctrl")])
    assert done.exit_code == 0, done.output
    source = (tmp_path / "ctrl" / "fotsmc_two_link.c").read_text("utf-8")
    assert "added[i] = state->g[i];" in source


def test_the_command_writes_what_learns(tmp_path):
    options = ("--learn", "--delay", "2", "--safeguard", "-o", str(tmp_path / "ctrl"))
    done = CliRunner().invoke(app, ["export", "two_link", *options])
    assert done.exit_code == 0, done.output
    header = (tmp_path / "ctrl" / "fotsmc_two_link.h").read_text("utf-8")
    assert "double sent[6];" in header
    assert "int fotsmc_two_link_regressor_due(" in header
    refused = CliRunner().invoke(app, ["export", "two_link", *options, "--float", "--force"])
    assert isinstance(refused.exception, ArgumentError)
