"""`export_data`: a recording as CSV, Parquet or MCAP, for other programs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.arms.columns import TIME
from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.files import replacing
from fotsmc_pin.simulation import Recording
from fotsmc_pin.view.data_table import blocks_of
from fotsmc_pin.view.mcap_file import write_mcap

if TYPE_CHECKING:
    import os

CLOCK = f"{TIME} [s]"


def export_data(rec: Recording | str | os.PathLike[str], path: str | os.PathLike[str]) -> Path:
    """Write everything that a recording holds as a table that other programs read.

    The suffix of `path` says how:

    - `.csv`: a row per recorded tick, heads such as `q.elbow [rad]`; numbers are written so that
      reading gives back the same bits. `fotsmc identify` reads the file.
    - `.parquet`: the same columns under names such as `q.elbow`, with the unit in the metadata of
      each field. Needs pyarrow.
    - `.mcap`: for PlotJuggler and Foxglove: a topic for each kind of column with a field for each
      joint, and `/joint_states` with `sensor_msgs/JointState`. The channels' metadata hold the
      units. Needs mcap and rosbags.

    Kinds are `q`, `v`, the reference's `q_d`, `v_d`, the errors `e`, `e_dot`, the applied torque
    `tau_commanded`, what sensors read (`q_measured`, `v_measured`, `tau_measured`) and every
    signal of the controller. Of a continuous joint the angle is written, without jumps. Controller,
    gains and versions stand in the metadata of Parquet and MCAP files.

    Args:
        rec: a recording, or the path of a saved one.
        path: the file, written whole or not at all; missing folders are made.

    Returns:
        The path of the file.

    Raises:
        ArgumentError: another suffix, or a recording without rows.
        MissingDependencyError: the library for this format is not installed.
    """
    rec = rec if isinstance(rec, Recording) else Recording.load(rec)
    target = Path(path)
    writer = WRITERS.get(target.suffix.lower())
    if writer is None:
        raise ArgumentError("path", str(path), f"give a file that ends in {' or '.join(WRITERS)}")
    if not len(rec):
        raise ArgumentError("rec", rec, "give a recording with rows")
    with replacing(target) as stream:
        writer(rec, stream)
    return target


def _write_csv(rec: Recording, stream: IO[bytes]) -> None:
    blocks = blocks_of(rec)
    heads = [CLOCK, *(head for block in blocks for head in block.heads)]
    table = np.column_stack([rec.t, *(block.values for block in blocks)])
    stream.write(f"# compensates: nothing\n{','.join(heads)}\n".encode())
    for row in table.tolist():
        stream.write((",".join(map(repr, row)) + "\n").encode())


def _write_parquet(rec: Recording, stream: IO[bytes]) -> None:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as error:
        raise MissingDependencyError(
            f"Parquet files need {error.name}: pip install pyarrow"
        ) from None
    columns: list[tuple[str, str, Any]] = [(TIME, "s", rec.t)]
    for block in blocks_of(rec):
        columns += [
            (f"{block.kind}.{name}", unit, block.values[:, k])
            for k, (name, unit) in enumerate(zip(block.names, block.units, strict=True))
        ]
    about = {"metadata": json.dumps(rec.metadata), "arm": rec.arm.name}
    schema = pa.schema(
        [
            pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit} if unit else None)
            for name, unit, _ in columns
        ],
        metadata=about,
    )
    arrays = [pa.array(np.ascontiguousarray(values)) for _, _, values in columns]
    pq.write_table(pa.Table.from_arrays(arrays, schema=schema), stream)


WRITERS = {".csv": _write_csv, ".parquet": _write_parquet, ".mcap": write_mcap}
