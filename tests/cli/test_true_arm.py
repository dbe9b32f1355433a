"""A second URDF as the plant: the run is the library's own; arms that do not fit are refused."""

import json
from pathlib import Path

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.paper import two_link
from fotsmc_pin.simulation import Recording

TRUE = Path(__file__).parents[2] / "urdf/two_link_true.urdf"
ARMS = Path(__file__).parent / "arms"


def assert_same_bits(one, other):
    for name in ("t", "q", "v", "q_d", "v_d", "e", "e_dot", "tau"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    for name, signal in other.signals.items():
        assert np.array_equal(one.signals[name], signal), name


def test_the_papers_plant_runs_as_in_the_library_to_the_bit(fotsmc, tmp_path):
    result = fotsmc("simulate", "two_link", "--true", TRUE)
    assert result.returncode == 0, result.stderr
    nominal = fp.load_arm("two_link")
    reference = fp.references.Sinusoid.inside_limits(nominal)
    controller = fp.RobustFONFTSM(nominal, dt=1e-3)
    ours = fp.simulate(fp.load_arm("two_link_true"), controller, reference, 10.0)
    assert_same_bits(Recording.load(tmp_path / "out/two_link/run.npz"), ours)


def test_the_papers_own_run_can_be_typed(fotsmc, tmp_path):
    result = fotsmc(
        *("simulate", "two_link", "--true", TRUE, "--controller", "AdaptiveFONFTSM"),
        *("--preset", "paper", "--reference", "paper", "--disturbance", "paper"),
        *("--substeps", two_link.SUBSTEPS, "--duration", "2", "--out", "run"),
    )
    assert result.returncode == 0, result.stderr
    assert_same_bits(Recording.load(tmp_path / "run/run.npz"), two_link.run(duration=2.0))


def test_every_perturbation_noise_and_delay_is_that_of_the_library(fotsmc, tmp_path):
    changes = {"mass_scale": 1.2, "com_shift": 0.01, "payload": 0.5, "friction": 0.3}
    options = [
        word
        for name, value in changes.items()
        for word in (f"--{name.replace('_', '-')}", str(value))
    ]
    result = fotsmc(
        *("simulate", "panda", *options, "--damping", "0.1:0.4", "--true-armature", "0.02"),
        *("--armature", "0.03", "--seed", "7", "--noise", "1e-5", "--delay", "1"),
        *("--integrator", "semi-implicit", "--substeps", "2", "--record-every", "5"),
        *("--start-error", "0.05", "--duration", "0.5", "--out", "run"),
    )
    assert result.returncode == 0, result.stderr
    nominal = fp.load_arm("panda", armature=0.03)
    true = fp.perturb(nominal, **changes, damping=fp.Uniform(0.1, 0.4), armature=0.02, seed=7)
    reference = fp.references.Sinusoid.inside_limits(nominal)
    from fotsmc_pin.simulation import NoisySensor, TickDelay

    ours = fp.simulate(
        true,
        fp.RobustFONFTSM(nominal, dt=1e-3),
        reference,
        0.5,
        q0=nominal.integrate(reference(0.0)[0], [0.05] * 7),
        sensor=NoisySensor(nominal, position=1e-5, velocity=1e-3, seed=7),
        actuator=TickDelay(1),
        integrator="semi-implicit",
        substeps=2,
        record_every=5,
    )
    kept = Recording.load(tmp_path / "run/run.npz")
    assert_same_bits(kept, ours)
    assert kept.arm.changes == true.changes


@pytest.mark.parametrize(
    ("nominal", "true", "says"),
    [
        ("two_link", "scara.urdf", "joint1 moves in two_link only; joint2 moves in two_link only"),
        ("gantry.urdf", "scara.urdf", "lift moves in"),
        ("turntable.urdf", "bounded.urdf", "yaw is continuous in turntable and revolute in"),
    ],
)
def test_a_plant_with_other_joints_is_refused_by_their_names(fotsmc, tmp_path, nominal, true, says):
    for file in ARMS.glob("*.urdf"):
        (tmp_path / file.name).write_text(file.read_text())
    bounded = (ARMS / "turntable.urdf").read_text()
    bounded = bounded.replace('name="yaw" type="continuous"', 'name="yaw" type="revolute"')
    (tmp_path / "bounded.urdf").write_text(
        bounded.replace('effort="40"', 'lower="-3" upper="3" effort="40"')
    )
    result = fotsmc("simulate", nominal, "--true", true)
    assert result.returncode == 2
    assert says in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_the_table_says_what_was_run(fotsmc):
    words = ("simulate", "two_link", "--true", TRUE, "--reference", "move", "--duration", "3")
    shown = " ".join(fotsmc(*words, COLUMNS="140").stdout.split())
    for word in ("RobustFONFTSM, preset default", "move for", "two_link, 2 joints", str(TRUE)):
        assert word in shown
    for word in ("time to rest", "swing at rest", "tool error", "mm RMS"):
        assert word in shown
    assert "inf" not in shown


def test_what_tune_found_can_be_run(fotsmc, tmp_path):
    pytest.importorskip("optuna")
    tuned = fotsmc(
        *("tune", "two_link", "--controller", "ComputedTorque", "--trials", "6"),
        *("--duration", "0.5", "--out", "tuned"),
    )
    assert tuned.returncode == 0, tuned.stderr
    front = json.loads((tmp_path / "tuned/front.json").read_text())["front"]
    last = len(front)
    words = ("simulate", "two_link", "--duration", "0.2", "--out", "run", "--gains")
    result = fotsmc(*words, f"tuned/front.json#{last}")
    assert result.returncode == 0, result.stderr
    told = Recording.load(tmp_path / "run/run.npz").metadata
    assert told["controller"] == "ComputedTorque"
    assert told["gains"]["kp"] == pytest.approx(front[-1]["gains"]["kp"])
    refused = fotsmc(*words, f"tuned/front.json#{last + 1}", "--force")
    assert refused.returncode == 2
    assert f"from 1 to {last}" in refused.stderr
