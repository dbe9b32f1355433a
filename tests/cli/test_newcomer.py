"""A newcomer's way with an arm of one's own: inspect, perturb, simulate, report, page."""

import json
from pathlib import Path

import pytest

import fotsmc_pin as fp
from fotsmc_pin.simulation import Recording

ARMS = Path(__file__).parent / "arms"
OWN = ("gantry", "scara", "turntable", "gripper")
WAYS = [*((name, ()) for name in OWN), ("baxter", ("--keep", "left_[sew]?"))]


@pytest.mark.parametrize(("name", "options"), WAYS, ids=[name for name, _ in WAYS])
def test_from_an_own_urdf_to_a_page(fotsmc, tmp_path, name, options):
    arm = name
    if name in OWN:
        arm = f"{name}.urdf"
        (tmp_path / arm).write_text((ARMS / arm).read_text())

    inspected = fotsmc("inspect", arm, *options)
    assert inspected.returncode == 0, inspected.stderr
    assert "Moving mass" in inspected.stdout

    changed = fotsmc(
        *("perturb", arm, *options, "--out", "true.urdf", "--seed", "1"),
        *("--mass-scale", "1.1:1.3", "--payload", "0.2", "--friction", "0.1"),
    )
    assert changed.returncode == 0, changed.stderr
    assert "drawn from seed 1" in changed.stdout

    words = ("--true", "true.urdf", "--reference", "move", "--duration", "4", "--out", "run")
    run = fotsmc("simulate", arm, *options, *words)
    assert run.returncode == 0, run.stderr
    metrics = json.loads((tmp_path / "run/metrics.json").read_text())
    assert metrics["tail_rms_error"] < 2e-3
    assert metrics["max_tail_tool_error"] < 2e-3
    assert len(list((tmp_path / "run").glob("*.html"))) == 1

    kept = Recording.load(tmp_path / "run/run.npz")
    assert kept.arm == fp.load_arm(tmp_path / "true.urdf")
    assert kept.arm.joint_names == fp.load_arm(tmp_path / "true.urdf").joint_names

    report = fotsmc("report", "run")
    assert report.returncode == 0, report.stderr
    assert (tmp_path / "run/report.html").stat().st_size > 10_000
    assert {path.name for path in tmp_path.iterdir()} <= {arm, "true.urdf", "run"}


def test_slides_are_told_in_metres_and_newtons(fotsmc, tmp_path):
    words = ("--reference", "move", "--duration", "3", "--out", "run", "--mass-scale", "1.2")
    run = fotsmc("simulate", ARMS / "scara.urdf", *words)
    assert run.returncode == 0, run.stderr
    assert "sliding:" in run.stdout
    assert " mm RMS" in run.stdout
    assert " N/s" in run.stdout
    parts = json.loads((tmp_path / "run/metrics.json").read_text())["by_unit"]
    rec = Recording.load(tmp_path / "run/run.npz")
    lift = rec.arm.joint_names.index("lift")
    assert rec.arm.position_units[lift] == "m"
    assert parts["m"]["peak_torque"] == pytest.approx(abs(rec.tau[:, lift]).max())
    assert parts["m"]["max_error"] == pytest.approx(abs(rec.e[:, lift]).max())


def test_a_name_with_slashes_and_markup_names_a_file_inside_the_folder(fotsmc, tmp_path):
    text = (ARMS / "gripper.urdf").read_text()
    (tmp_path / "own.urdf").write_text(text.replace("gripper arm/v2 [bold]", "../../[red]up"))
    run = fotsmc("simulate", "own.urdf", "--duration", "0.2")
    assert run.returncode == 0, run.stderr
    assert "[red]up" in run.stdout
    assert {path.name for path in tmp_path.iterdir()} == {"own.urdf", "out"}
    (folder,) = (tmp_path / "out").iterdir()
    assert len(list(folder.glob("*.html"))) == 1
