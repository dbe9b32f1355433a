"""A recording as an MCAP file of ROS 2 messages, which needs no ROS to be written or read."""

from __future__ import annotations

import json
import re
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.errors import MissingDependencyError
from fotsmc_pin.view.data_table import TORQUE, blocks_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array
    from fotsmc_pin.view.data_table import Block

JOINT_STATE = "sensor_msgs/msg/JointState"
TIME_MESSAGE = "builtin_interfaces/msg/Time"
CDR_HEADER = b"\x00\x01\x00\x00"
"""Encapsulation of a message: plain CDR, little-endian. Eight-byte numbers follow it aligned."""
SECOND = 1_000_000_000


def write_mcap(rec: Recording, stream: IO[bytes]) -> None:
    """Write a topic for each kind of column, `/joint_states`, and the run's metadata.

    Raises:
        MissingDependencyError: mcap or rosbags is not installed.
    """
    try:
        from mcap.writer import Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise MissingDependencyError(
            f"MCAP files need {error.name}: pip install mcap rosbags"
        ) from None
    writer, store = Writer(stream), get_typestore(Stores.ROS2_HUMBLE)
    writer.start(profile="ros2", library="fotsmc_pin")
    stamps = [round(t * SECOND) for t in rec.t.tolist()]
    blocks = blocks_of(rec)
    for block in blocks:
        name = f"fotsmc_pin/msg/{message_name(block.kind)}"
        definition, about = definition_of(block)
        schema = writer.register_schema(name, "ros2msg", definition.encode())
        channel = writer.register_channel(f"/{block.kind}", "cdr", schema, about)
        rows = np.ascontiguousarray(block.values, dtype="<f8")
        _send(writer, channel, stamps, (CDR_HEADER + row.tobytes() for row in rows))
    definition, _ = store.generate_msgdef(JOINT_STATE, ros_version=2)
    schema = writer.register_schema(JOINT_STATE, "ros2msg", definition.encode())
    channel = writer.register_channel("/joint_states", "cdr", schema)
    _send(writer, channel, stamps, _joint_states(store, rec, stamps, blocks))
    writer.add_metadata("run", {"arm": rec.arm.name, "metadata": json.dumps(rec.metadata)})
    writer.finish()  # type: ignore[no-untyped-call]


def definition_of(block: Block) -> tuple[str, dict[str, str]]:
    """Return a message's definition with a field for each column, and the channel's metadata."""
    lines: list[str] = []
    about: dict[str, str] = {}
    for name, field, unit in zip(block.names, field_names(block.names), block.units, strict=True):
        lines.append(f"float64 {field}" + (f"  # {name} [{unit}]" if unit else f"  # {name}"))
        about |= {f"name.{field}": name} | ({f"unit.{field}": unit} if unit else {})
    return "\n".join(lines) + "\n", about


def message_name(kind: str) -> str:
    """Return a kind of column as ROS 2 takes it for a message, such as `TauMeasured`."""
    parts = re.findall(r"[A-Za-z0-9]+", kind)
    name = "".join(part[:1].upper() + part[1:] for part in parts)
    return name if name[:1].isalpha() else f"Part{name}"


def field_names(names: Iterable[str]) -> list[str]:
    """Return names as ROS 2 takes them for fields: lower case, a letter first, none twice."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
        field = stem = plain if plain[:1].isalpha() else f"part_{plain}".rstrip("_")
        count = 1
        while field in found:
            count += 1
            field = f"{stem}_{count}"
        found.append(field)
    return found


def _send(writer: Any, channel: int, stamps: list[int], messages: Iterable[bytes]) -> None:
    for k, (stamp, data) in enumerate(zip(stamps, messages, strict=True)):
        writer.add_message(channel, stamp, data, stamp, k)


def _joint_states(
    store: Any, rec: Recording, stamps: list[int], blocks: list[Block]
) -> Iterable[bytes]:
    """Yield what a robot's driver would send: what sensors read, where there are some."""
    tables = {block.kind: block.values for block in blocks}
    q, v = (tables.get(f"{kind}_measured", tables[kind]) for kind in "qv")
    tau: Array = tables.get("tau_measured", tables[TORQUE])
    message, header, time = (
        store.types[name] for name in (JOINT_STATE, "std_msgs/msg/Header", TIME_MESSAGE)
    )
    for k, stamp in enumerate(stamps):
        seconds, rest = divmod(stamp, SECOND)
        state = message(
            header=header(stamp=time(sec=seconds, nanosec=rest), frame_id=""),
            name=[*rec.arm.joint_names],
            position=q[k],
            velocity=v[k],
            effort=tau[k],
        )
        yield bytes(store.serialize_cdr(state, JOINT_STATE))
