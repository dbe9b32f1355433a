"""`export_data`: what other programs read is what the recording holds, to the last bit."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from typer.testing import CliRunner

import fotsmc_pin as fp
from fotsmc_pin.cli import app
from fotsmc_pin.errors import ArgumentError, OutputExistsError
from fotsmc_pin.simulation import Chain, Encoder, TorqueSensor
from fotsmc_pin.view.data_table import blocks_of
from fotsmc_pin.view.mcap_file import field_names, message_name


@pytest.fixture(scope="module")
def rec():
    """Return a short run of an arm with continuous joints and all sensors."""
    arm = fp.load_arm("kinova")
    assert arm.nq > arm.nv
    return fp.simulate(
        arm,
        fp.ComputedTorque(arm, dt=1e-3),
        fp.references.Sinusoid.inside_limits(arm),
        0.05,
        sensor=Chain(Encoder(arm, 1e-3, bits=20), TorqueSensor(arm, noise=0.1)),
    )


def columns(rec):
    """Return a few columns by kind, which each format must give back to the last bit."""
    angles = {block.kind: block.values for block in blocks_of(rec)}["q_d"]
    turns = (angles - [rec.arm.to_joint_positions(q) for q in rec.q_d]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)
    return {
        "v": rec.v,
        "q_d": angles,
        "e_dot": rec.e_dot,
        "tau_commanded": rec.tau,
        "tau_measured": rec.tau_measured,
    }


def test_csv_is_read_back(rec, tmp_path):
    path = fp.export_data(rec, tmp_path / "run.csv")
    comment, header = path.read_text("utf-8").splitlines()[:2]
    assert comment == "# compensates: nothing"
    heads = header.split(",")
    table = np.loadtxt(path, delimiter=",", skiprows=2)
    np.testing.assert_array_equal(table[:, 0], rec.t)
    first = rec.arm.joint_names[0]
    units = {"v": "rad/s", "q_d": "rad", "e_dot": "rad/s"}
    for kind, values in columns(rec).items():
        start = heads.index(f"{kind}.{first} [{units.get(kind, 'N·m')}]")
        np.testing.assert_array_equal(table[:, start : start + rec.arm.nv], values)


def test_a_csv_file_is_a_log(rec, tmp_path):
    log = fp.read_log(fp.export_data(rec, tmp_path / "run.csv"), rec.arm, torque="commanded")
    np.testing.assert_allclose(log.tau, rec.tau, atol=1e-9)


def test_parquet_is_read_back(rec, tmp_path):
    table = pq.read_table(fp.export_data(rec, tmp_path / "run.parquet"))
    np.testing.assert_array_equal(table["t"], rec.t)
    for kind, values in columns(rec).items():
        for name, column in zip(rec.arm.joint_names, values.T, strict=True):
            np.testing.assert_array_equal(table[f"{kind}.{name}"], column)
    assert table.schema.field(f"v.{rec.arm.joint_names[0]}").metadata[b"unit"] == b"rad/s"
    assert json.loads(table.schema.metadata[b"metadata"]) == rec.metadata


def test_mcap_is_read_back(rec, tmp_path):
    path = fp.export_data(rec, tmp_path / "run.mcap")
    found = {}
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time, decoded))
        about = {c.topic: c.metadata for c in reader.get_summary().channels.values()}
    stamps = [time for time, _ in found["/v"]]
    np.testing.assert_allclose(np.array(stamps) * 1e-9, rec.t, atol=1e-9)
    fields = field_names(rec.arm.joint_names)
    for kind, values in columns(rec).items():
        rows = [[getattr(row, field) for field in fields] for _, row in found[f"/{kind}"]]
        np.testing.assert_array_equal(rows, values)
        assert about[f"/{kind}"][f"name.{fields[0]}"] == rec.arm.joint_names[0]
    assert about["/tau_commanded"][f"unit.{fields[0]}"] == "N·m"
    for name, values in rec.signals.items():
        rows = [[getattr(row, f) for f in row.__slots__] for _, row in found[f"/{name}"]]
        np.testing.assert_array_equal(rows, values)
    states = [state for _, state in found["/joint_states"]]
    np.testing.assert_array_equal([state.effort for state in states], rec.tau_measured)
    assert states[0].name == [*rec.arm.joint_names]


def test_joint_states_of_an_mcap_file_are_a_log(rec, tmp_path):
    path = fp.export_data(rec, tmp_path / "run.mcap")
    log = fp.read_log(path, rec.arm, torque="measured", compensates=())
    np.testing.assert_array_equal(log.tau, rec.tau_measured)


def test_fields_are_what_ros_takes():
    names = ["Joint 1", "joint-1", "7", "_x__y_", "Σ"]
    assert field_names(names) == ["joint_1", "joint_1_2", "part_7", "x_y", "part"]
    assert [message_name(kind) for kind in ("s", "tau_measured", "3d")] == [
        "S",
        "TauMeasured",
        "Part3d",
    ]


@pytest.mark.parametrize("name", ["run.xlsx", "run"])
def test_another_suffix_is_refused(rec, name, tmp_path):
    with pytest.raises(ArgumentError, match=r"ends in \.csv"):
        fp.export_data(rec, tmp_path / name)
    assert not [*tmp_path.iterdir()]


def test_a_run_is_converted_by_the_command_line(rec, tmp_path):
    rec.save(tmp_path / "run.npz")
    words = ["convert", str(tmp_path / "run.npz"), "-o", str(tmp_path / "run.csv")]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert (tmp_path / "run.csv").read_text("utf-8").count("\n") == len(rec) + 2
    assert isinstance(CliRunner().invoke(app, words).exception, OutputExistsError)
