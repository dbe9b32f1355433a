"""Logs as ROS 2 bags and MCAP files with `sensor_msgs/JointState`, read without ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.checks import did_you_mean
from fotsmc_pin.errors import FotsmcError, LogError, MissingDependencyError
from fotsmc_pin.identification.log_table import LogTable

if TYPE_CHECKING:
    from pathlib import Path

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

MESSAGE = "sensor_msgs/msg/JointState"
NANOSECOND = 1e-9


def read_ros(path: Path, arm: Arm, topic: str | None) -> LogTable:
    """Return the joint states of a ROS 2 bag (a folder, .db3) or of an MCAP file.

    The stamp of each message's header is its time; where all of these are zero, the time at which
    the bag received it. Messages without any joint of the arm, as a gripper may send on the same
    topic, are passed over. Positions are rad and m, efforts N·m and N, as the message's definition
    says.

    Args:
        path: the bag.
        arm: whose joints to take.
        topic: name of the topic; may be left out where one only has joint states of the arm.

    Raises:
        MissingDependencyError: rosbags is not installed.
        LogError: no such topic, several to choose from, a joint without state, or a damaged bag.
    """
    any_reader, store = _rosbags()
    try:  # The parsers raise many kinds on damaged bytes.
        with any_reader([path], default_typestore=store) as bag:
            connections = _connections(path, bag, topic)
            rows = [
                (stamp, bag.deserialize(raw, MESSAGE))
                for _, stamp, raw in bag.messages(connections=connections)
            ]
    except FotsmcError:
        raise
    except Exception as error:
        raise LogError("file", f"{path}: not a ROS 2 bag that can be read ({error})") from error
    source = f"{path} ({connections[0].topic})"
    return _table(source, rows, arm)


def _rosbags() -> tuple[Any, Any]:
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise MissingDependencyError(
            f"ROS bags and MCAP files need {error.name}: pip install rosbags"
        ) from None
    # Bags older than 2023 hold no definitions: those of JointState have never changed.
    store = get_typestore(Stores.ROS2_HUMBLE)
    return AnyReader, store


def _connections(path: Path, bag: Any, topic: str | None) -> list[Any]:
    states = [c for c in bag.connections if c.msgtype == MESSAGE and c.msgcount]
    topics = sorted({connection.topic for connection in states})
    if not topics:
        held = ", ".join(sorted({c.msgtype for c in bag.connections})) or "nothing"
        raise LogError("file", f"{path}: no {MESSAGE} in it; it holds {held}")
    if topic is None and len(topics) > 1:
        raise LogError(
            "columns",
            f"{path}: joint states on {', '.join(topics)}; say which, topic={topics[0]!r}",
        )
    chosen = topics[0] if topic is None else topic
    if chosen not in topics:
        hint = did_you_mean(chosen, topics)
        raise LogError(
            "columns", f"{path}: no joint states on {chosen!r}; {hint}there are {', '.join(topics)}"
        )
    return [connection for connection in states if connection.topic == chosen]


def _table(source: str, rows: list[tuple[int, Any]], arm: Arm) -> LogTable:
    notes = []
    own = [row for row in rows if set(row[1].name) & set(arm.joint_names)]
    if not own:
        names = sorted({name for _, message in rows for name in message.name})
        hint = did_you_mean(arm.joint_names[0], names)
        raise LogError(
            "columns",
            f"{source}: no message about any joint of {arm.name} ({', '.join(arm.joint_names)}); "
            f"{hint}there are {', '.join(names)}",
        )
    if len(own) < len(rows):
        notes.append(f"{len(rows) - len(own)} messages about other joints passed over")
    kinds = {tuple(message.name) for _, message in own}
    everywhere = set.intersection(*map(set, kinds))
    partly = [n for n in arm.joint_names if n not in everywhere and any(n in k for k in kinds)]
    if partly:
        raise LogError(
            "columns",
            f"{source}: some messages lack {', '.join(partly)}: joint states of one arm in several "
            "messages cannot be put together; record the topic that has them all",
        )
    t, stamped = _times(own)
    if not stamped:
        notes.append("the headers have no stamps: the bag's own are taken, network delay included")
    return LogTable(
        source=source,
        t=t,
        q=_by_joint(source, own, "position", required=True),
        v=_by_joint(source, own, "velocity"),
        tau={"": effort} if (effort := _by_joint(source, own, "effort")) else {},
        notes=notes,
    )


def _times(rows: list[tuple[int, Any]]) -> tuple[Array, bool]:
    """Return times since the first message, and whether its headers are what tells them.

    Nanoseconds since 1970 have too many digits for a float: whole numbers are subtracted.
    """
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in rows]
    stamped = any(stamps)
    ticks = stamps if stamped else [received for received, _ in rows]
    return np.array([(tick - ticks[0]) * NANOSECOND for tick in ticks]), stamped


def _by_joint(
    source: str, rows: list[tuple[int, Any]], what: str, *, required: bool = False
) -> dict[str, Array]:
    """Return one field of all messages by joint; empty where the messages leave it out."""
    sizes = {len(getattr(message, what)) for _, message in rows}
    if sizes == {0} and not required:
        return {}
    names = tuple(rows[0][1].name)
    table = []
    for _, message in rows:
        values, own = getattr(message, what), tuple(message.name)
        if len(values) != len(own):
            raise LogError(
                "file",
                f"{source}: a message has {len(own)} names and {len(values)} numbers of {what}",
            )
        if own == names:
            table.append(values)
        else:
            place = {name: k for k, name in enumerate(own)}
            table.append([values[place[name]] if name in place else np.nan for name in names])
    array = np.array(table, dtype=np.float64)
    known = {
        name: column
        for name, column in zip(names, array.T, strict=True)
        if not np.isnan(column).any()
    }
    return {name: np.ascontiguousarray(column) for name, column in known.items()}
