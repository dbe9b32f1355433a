"""Bags of ROS 2 and MCAP files, written by rosbags in the test and read back without ROS."""

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import fotsmc_pin as fp
from fotsmc_pin.errors import LogError, MissingDependencyError
from fotsmc_pin.identification import LogWarning

STORE = get_typestore(Stores.ROS2_JAZZY)
STATE = "sensor_msgs/msg/JointState"
KNOWN = {"torque": "measured", "compensates": ()}
NOW = 1_760_000_000 * 10**9
RATE = 250.0


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("panda")


class States:
    """Joint states of an arm whose joints come in another order, with fingers."""

    def __init__(self, arm, rows=150):
        self.arm, self.t = arm, np.arange(rows) / RATE
        middle = 0.5 * (arm.lower_position_limit + arm.upper_position_limit)
        speed = 2.0 + 0.3 * np.arange(arm.nv)
        self.x = middle + 0.4 * np.sin(np.outer(self.t, speed))
        self.v = 0.4 * speed * np.cos(np.outer(self.t, speed))
        self.tau = np.cos(np.outer(self.t, speed))

    def messages(self, *, extra=("finger",), shift=0, stamped=True, fields=("q", "v", "tau")):
        """Return pairs of the time of receipt [ns] and a message."""
        names = [*extra, *reversed(self.arm.joint_names)]
        rows = []
        for k, instant in enumerate(self.t):
            tick = NOW + round(instant * 1e9)
            parts = [
                np.concatenate([np.zeros(len(extra)), values[k, ::-1]]) if name in fields else []
                for name, values in (("q", self.x), ("v", self.v), ("tau", self.tau))
            ]
            rows.append((tick + shift, state(tick if stamped else 0, names, *parts)))
        return rows


def state(tick, names, position, velocity, effort):
    stamp = STORE.types["builtin_interfaces/msg/Time"](sec=tick // 10**9, nanosec=tick % 10**9)
    header = STORE.types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
    numbers = [np.asarray(part, dtype=np.float64) for part in (position, velocity, effort)]
    return STORE.types[STATE](header, list(names), *numbers)


def write(path, topics, plugin=StoragePlugin.SQLITE3):
    """Write a bag, and return its folder."""
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, STATE, typestore=STORE)
            for received, message in messages:
                writer.write(connection, received, STORE.serialize_cdr(message, STATE))
    return path


@pytest.fixture(scope="module")
def states(arm):
    return States(arm)


@pytest.mark.parametrize("plugin", list(StoragePlugin))
@pytest.mark.parametrize("inner", [False, True])
def test_bags_and_files_are_read(states, arm, tmp_path, plugin, inner):
    folder = write(tmp_path / "bag", {"/joint_states": states.messages()}, plugin)
    suffix = ".mcap" if plugin is StoragePlugin.MCAP else ".db3"
    path = next(folder.glob(f"*{suffix}")) if inner else folder
    log = fp.read_log(path, arm, **KNOWN)
    np.testing.assert_allclose(log.t, states.t, atol=1e-9)
    np.testing.assert_allclose(log.q, states.x, atol=1e-12)
    np.testing.assert_allclose(log.v, states.v, atol=1e-12)
    np.testing.assert_allclose(log.tau, states.tau, atol=1e-12)
    assert any("finger" in note for note in log.notes)
    assert "/joint_states" in log.source


def test_the_meaning_of_effort_must_be_given(states, arm, tmp_path):
    bag = write(tmp_path / "bag", {"/joint_states": states.messages()})
    with pytest.raises(LogError, match="torque='measured'"):
        fp.read_log(bag, arm, compensates=())
    with pytest.raises(LogError, match="compensates="):
        fp.read_log(bag, arm, torque="measured")


def test_of_several_topics_one_is_named(states, arm, tmp_path):
    topics = {"/joint_states": states.messages(), "/desired": states.messages()[:50]}
    bag = write(tmp_path / "bag", topics)
    with pytest.raises(LogError, match="/desired, /joint_states; say which"):
        fp.read_log(bag, arm, **KNOWN)
    with pytest.raises(LogError, match="did you mean /joint_states"):
        fp.read_log(bag, arm, topic="/joint_state", **KNOWN)
    assert len(fp.read_log(bag, arm, topic="/desired", **KNOWN)) == 50


def test_messages_of_a_gripper_on_the_same_topic_are_passed_over(states, arm, tmp_path):
    messages = states.messages()
    grip = [
        (tick + 1000, state(tick + 1000, ["finger"], [0.0], [0.0], [1.0])) for tick, _ in messages
    ]
    bag = write(tmp_path / "bag", {"/joint_states": sorted(messages + grip, key=lambda m: m[0])})
    log = fp.read_log(bag, arm, **KNOWN)
    np.testing.assert_allclose(log.q, states.x, atol=1e-12)
    assert any("150 messages about other joints" in note for note in log.notes)


def test_an_arm_in_two_messages_is_refused(states, arm, tmp_path):
    messages = states.messages()
    half = [
        (
            tick,
            state(
                tick,
                message.name[:4],
                *(x[:4] for x in (message.position, message.velocity, message.effort)),
            ),
        )
        for tick, message in messages
    ]
    bag = write(tmp_path / "bag", {"/joint_states": messages[:50] + half[50:]})
    with pytest.raises(LogError, match="some messages lack panda_joint1"):
        fp.read_log(bag, arm, **KNOWN)


def test_messages_without_stamps_take_the_bags(states, arm, tmp_path):
    bag = write(tmp_path / "bag", {"/joint_states": states.messages(stamped=False)})
    log = fp.read_log(bag, arm, **KNOWN)
    np.testing.assert_allclose(log.t, states.t, atol=1e-9)
    assert any("no stamps" in note for note in log.notes)


def test_messages_that_come_twice_or_not_at_all_are_said(states, arm, tmp_path):
    messages = states.messages()
    bag = write(
        tmp_path / "bag", {"/joint_states": messages[:50] + messages[49:100] + messages[102:]}
    )
    with pytest.warns(LogWarning) as told:
        log = fp.read_log(bag, arm, **KNOWN)
    words = " ".join(str(warning.message) for warning in told)
    assert "1 stamps stand twice" in words
    assert "2 rows are missing" in words
    assert len(log) == 150


@pytest.mark.parametrize(
    ("fields", "match"),
    [(("q", "v"), "no torque for any joint"), (("v", "tau"), "8 names and 0 numbers of position")],
)
def test_what_messages_leave_out(states, arm, tmp_path, fields, match):
    bag = write(tmp_path / "bag", {"/joint_states": states.messages(fields=fields)})
    with pytest.raises(LogError, match=match):
        fp.read_log(bag, arm, **KNOWN)


def test_another_robots_bag_names_its_joints(states, tmp_path):
    bag = write(tmp_path / "bag", {"/joint_states": states.messages()})
    with pytest.raises(LogError, match=r"no message about any joint of ur5.*panda_joint1"):
        fp.read_log(bag, fp.load_arm("ur5"), **KNOWN)


def test_what_is_no_bag(arm, tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "log.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(40))
    (tmp_path / "log.db3").write_bytes(b"not a database")
    for name in ("empty", "log.mcap", "log.db3"):
        with pytest.raises(LogError, match="not a ROS 2 bag"):
            fp.read_log(tmp_path / name, arm, **KNOWN)
    other = tmp_path / "bag"
    with Writer(other, version=9) as writer:
        connection = writer.add_connection("/chat", "std_msgs/msg/String", typestore=STORE)
        text = STORE.types["std_msgs/msg/String"]("hello")
        writer.write(connection, NOW, STORE.serialize_cdr(text, "std_msgs/msg/String"))
    with pytest.raises(LogError, match="holds std_msgs/msg/String"):
        fp.read_log(other, arm, **KNOWN)


def test_without_rosbags_the_remedy_is_said(states, arm, tmp_path, monkeypatch):
    bag = write(tmp_path / "bag", {"/joint_states": states.messages()})
    monkeypatch.setitem(__import__("sys").modules, "rosbags.highlevel", None)
    with pytest.raises(MissingDependencyError, match="pip install rosbags"):
        fp.read_log(bag, arm, **KNOWN)
