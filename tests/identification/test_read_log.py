"""Logs from files: columns by name, units, the clock, and what the torque means."""

import warnings

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms.columns import heads
from fotsmc_pin.errors import ArgumentError, LogError, RecordingError
from fotsmc_pin.identification import LogWarning
from fotsmc_pin.identification.reading import read_logs

RATE = 200.0
KNOWN = {"torque": "measured", "compensates": ()}


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("panda")


class Motion:
    """Two seconds of a smooth motion of every joint, as columns by head."""

    def __init__(self, arm, t=None, torque="tau_measured"):
        self.arm, self.t = arm, np.arange(0.0, 2.0, 1.0 / RATE) if t is None else t
        middle = 0.5 * (arm.lower_position_limit + arm.upper_position_limit)
        speed = 2.0 + 0.3 * np.arange(arm.nv)
        self.x = middle + 0.4 * np.sin(np.outer(self.t, speed))
        self.v = 0.4 * speed * np.cos(np.outer(self.t, speed))
        self.tau = np.sin(np.outer(self.t, speed + 1.0))
        table = np.column_stack([self.t, self.x, self.v, self.tau])
        self.columns = dict(zip(heads(arm, ("q", "v", torque)), table.T, strict=True))

    def write(self, path, comment="# compensates: nothing\n", rows=slice(None)):
        lines = [",".join(self.columns)]
        lines += [
            ",".join(map(repr, row)) for row in np.array([*self.columns.values()]).T[rows].tolist()
        ]
        path.write_text(comment + "\n".join(lines) + "\n", "utf-8")
        return path

    def rename(self, old, new):
        self.columns = {head.replace(old, new): c for head, c in self.columns.items()}


@pytest.fixture
def motion(arm):
    return Motion(arm)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "log.csv"


def refused(path, arm, match, **said):
    with pytest.raises(LogError, match=match):
        fp.read_log(path, arm, **said)


def test_a_csv_file_is_read_as_it_is(motion, path, arm):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        log = fp.read_log(motion.write(path), arm)
    np.testing.assert_allclose(log.q, motion.x, atol=1e-12)
    np.testing.assert_allclose(log.v, motion.v, atol=1e-12)
    np.testing.assert_allclose(log.tau, motion.tau, atol=1e-12)
    assert (log.torque, log.compensates) == ("measured", ())
    assert any("not resampled" in note for note in log.notes)


def test_columns_are_found_by_name_in_any_order_beside_others(motion, path, arm):
    order = np.random.default_rng(0).permutation(len(motion.columns))
    names = list(motion.columns)
    motion.columns = {names[k]: motion.columns[names[k]] for k in order}
    fingers = {"q.finger [m]": motion.t, "temperature.motor [degC]": motion.t, "note": motion.t}
    motion.columns = fingers | motion.columns
    log = fp.read_log(motion.write(path), arm)
    np.testing.assert_allclose(log.tau, motion.tau, atol=1e-12)
    assert any("finger" in note for note in log.notes)


@pytest.mark.parametrize("kind", ["q", "v", "tau_measured"])
def test_a_missing_column_is_named_with_the_one_that_is_near(motion, path, arm, kind):
    motion.rename(f"{kind}.panda_joint3", f"{kind}.panda_joint_3")
    match = "panda_joint3.*did you mean panda_joint_3" if kind == "q" else "no .*panda_joint3"
    refused(motion.write(path), arm, match)


def test_a_log_without_velocities_says_so(motion, path, arm):
    motion.columns = {h: c for h, c in motion.columns.items() if not h.startswith("v.")}
    log = fp.read_log(motion.write(path), arm)
    assert log.v is None
    assert any("no velocities" in note for note in log.notes)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("q.panda_joint2 [rad]", "q.panda_joint2 [deg]", r"is in deg: multiply .* π/180"),
        ("v.panda_joint2 [rad/s]", "v.panda_joint2 [deg/s]", r"is in deg/s: multiply .* π/180"),
        ("panda_joint2 [N·m]", "panda_joint2 [mNm]", r"is in mNm: convert.*\[N·m\]"),
        ("t [s]", "t [ns]", "is in ns: divide the column by 1e9"),
        ("q.panda_joint2 [rad]", "q.panda_joint2", r"states no unit: write q.panda_joint2 \[rad\]"),
        ("t [s]", "t", "states no unit"),
        ("t [s]", "time [s]", "no column 't"),
        ("q.panda_joint2 [rad]", "q.panda_joint1 [rad]", "stands twice"),
    ],
)
def test_a_head_that_cannot_be_is_named(motion, path, arm, old, new, match):
    lines = motion.write(path).read_text("utf-8").splitlines()
    lines[1] = lines[1].replace(old, new)
    path.write_text("\n".join(lines), "utf-8")
    refused(path, arm, match)


@pytest.mark.parametrize("unit", ["Nm", "N m", "N*m"])
def test_other_spellings_of_a_unit_are_read(motion, path, arm, unit):
    motion.rename("N·m", unit)
    assert len(fp.read_log(motion.write(path), arm)) == len(motion.t)


# The clock.


def test_stamps_that_stand_twice_count_once(arm, path):
    t = np.arange(400) / RATE
    motion = Motion(arm, np.sort(np.append(t, t[[50, 90]])))
    with pytest.warns(LogWarning, match=r"2 stamps stand twice, first 0\.25 s"):
        log = fp.read_log(motion.write(path), arm)
    assert len(log) == 400
    np.testing.assert_allclose(np.diff(log.t), 1.0 / RATE)


def test_rows_that_are_missing_are_bridged_and_said(arm, path):
    t = np.delete(np.arange(400) / RATE, [100, 101, 300])
    with pytest.warns(LogWarning, match="3 rows are missing in 2 gaps of up to 15 ms"):
        log = fp.read_log(Motion(arm, t).write(path), arm)
    assert len(log) == 400
    np.testing.assert_allclose(log.q, Motion(arm, np.arange(400) / RATE).x, atol=2e-4)


def test_a_log_with_a_gap_stays_in_pieces_and_it_is_said(arm, path):
    t = np.concatenate([np.arange(100), np.arange(300, 600), np.arange(700, 705)]) / RATE
    motion = Motion(arm, t)
    words = r"gaps \(1\.005 s at 0\.495 s, 0\.505 s at 2\.995 s\): 2 pieces .* 5 rows in shorter"
    with pytest.warns(LogWarning, match=words):
        log = fp.read_log(motion.write(path), arm)
    np.testing.assert_allclose(log.t, t[:400], atol=1e-12)
    np.testing.assert_allclose(log.q, motion.x[:400], atol=1e-12)
    first = fp.read_log(path, arm, stop=0.495)
    np.testing.assert_allclose(first.q, motion.x[:100], atol=1e-12)
    refused(Motion(arm, np.arange(60) // 12 + np.arange(60) / RATE).write(path), arm, "no 20 rows")


def test_stamps_that_run_backwards_are_refused_and_a_few_late_rows_put_in_order(arm, path):
    t = np.arange(400) / RATE
    refused(Motion(arm, np.concatenate([t, t])).write(path), arm, "run backwards, first from 1.995")
    late = t.copy()
    late[[200, 201]] = late[[201, 200]]
    with pytest.warns(LogWarning, match="1 rows came after later ones"):
        log = fp.read_log(Motion(arm, late).write(path), arm)
    np.testing.assert_allclose(log.q, Motion(arm, t).x, atol=1e-12)


def test_rows_at_uneven_times_are_resampled_and_it_is_stated(arm, path):
    rng = np.random.default_rng(0)
    t = (np.arange(400) + 0.2 * rng.uniform(-1.0, 1.0, 400)) / RATE
    log = fp.read_log(Motion(arm, t).write(path), arm)
    assert any("resampled at 20" in note and "straight lines" in note for note in log.notes)
    assert np.ptp(np.diff(log.t)) < 1e-9
    np.testing.assert_allclose(log.q, Motion(arm, t[0] + log.t).x, atol=5e-5)


def test_too_short_a_log_is_refused(motion, path, arm):
    refused(motion.write(path, rows=slice(5)), arm, "5 rows")


# What the torque means.


def test_the_meaning_of_torque_must_be_given(arm, path):
    bare = Motion(arm, torque="tau").write(path, comment="")
    refused(bare, arm, "where its torque comes from.*torque='measured'", compensates=())
    refused(
        bare, arm, r"whether its torque is total.*compensates=\('gravity',\)", torque="measured"
    )
    log = fp.read_log(bare, arm, torque="commanded", compensates=("gravity",))
    assert (log.torque, log.compensates) == ("commanded", ("gravity",))


def test_what_the_file_says_is_believed_and_not_overruled(arm, path):
    motion = Motion(arm, torque="tau_commanded")
    motion.write(path, comment="# compensates: gravity, friction\n")
    log = fp.read_log(path, arm)
    assert (log.torque, log.compensates) == ("commanded", ("gravity", "friction"))
    refused(path, arm, "compensates gravity and friction, and", compensates=())
    refused(path, arm, "holds commanded torque and no measured one", torque="measured")


def test_kinds_of_torque_are_not_mixed(motion, path, arm):
    motion.rename("tau_measured.panda_joint7", "tau_commanded.panda_joint7")
    refused(
        motion.write(path), arm, "mixes kinds of torque .*commanded of panda_joint7.*for dynamics"
    )


def test_of_two_kinds_one_is_chosen(motion, path, arm):
    for joint in arm.joint_names:
        motion.columns[f"tau_commanded.{joint} [N·m]"] = np.zeros_like(motion.t)
    refused(motion.write(path), arm, "measured and commanded torque: say which")
    assert not fp.read_log(path, arm, torque="commanded").tau.any()
    assert fp.read_log(path, arm, torque="measured").tau.any()


def test_logs_of_different_kinds_are_not_used_together(motion, path, arm):
    one = fp.read_log(motion.write(path), arm)
    motion.rename("tau_measured", "tau")
    for said, match in (
        ({"torque": "commanded", "compensates": ()}, "total, measured; .*total, commanded"),
        ({"torque": "measured", "compensates": ("gravity",)}, "without gravity, measured"),
    ):
        other = fp.read_log(motion.write(path, comment=""), arm, **said)
        with pytest.raises(ArgumentError, match=match):
            read_logs(arm, [one, other])


def test_a_word_that_means_nothing(motion, path, arm):
    motion.write(path, comment="")
    refused(path, arm, "did you mean gravity", compensates=("gravitiy",))


# Files.


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "no header"),
        ("# only a comment\n", "no header"),
        ("t [s],q.a [rad]\n0,x\n", "no position of|line 2"),
    ],
)
def test_a_file_that_is_no_log(path, arm, text, match):
    path.write_text(text, "utf-8")
    refused(path, arm, match, **KNOWN)


def test_a_row_that_is_none_is_named_by_its_line(motion, path, arm):
    lines = motion.write(path).read_text("utf-8").splitlines()
    for broken, match in (("1,2,3", "line 42"), (lines[41].replace("0.", "x.", 1), "line 42")):
        path.write_text("\n".join([*lines[:41], broken, *lines[42:]]), "utf-8")
        refused(path, arm, match)
    cells = lines[41].split(",")
    path.write_text("\n".join([*lines[:41], ",".join(["nan", *cells[1:]]), *lines[42:]]), "utf-8")
    refused(path, arm, "line 42 holds what is not finite")


def test_other_files(tmp_path, arm):
    with pytest.raises(FileNotFoundError):
        fp.read_log(tmp_path / "none.csv", arm)
    (tmp_path / "log.xlsx").write_bytes(b"PK")
    refused(tmp_path / "log.xlsx", arm, "give a recording")
    (tmp_path / "log.npz").write_bytes(b"PK")
    with pytest.raises(RecordingError):
        fp.read_log(tmp_path / "log.npz", arm)
    (tmp_path / "log.csv").write_bytes(b"\xff\xfe\x00\x01")
    refused(tmp_path / "log.csv", arm, "UTF-8")
