"""Logs of robots: MCAP files and ROS bags, whose messages become channels over their times; tables in Parquet as LeRobot writes them."""

from __future__ import annotations

import io
import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_of_heading
from stickslip.basics.unpacking import Allowance
from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.records.extras import damage_reported, library
from stickslip.records.raw import Raw, RawColumn

#: Units that messages of ROS define, by the field that holds the numbers (REP 103); of joints those of ones that turn.
_UNITS = {
    "force": "N", "torque": "N m", "angular_velocity": "rad/s", "linear_acceleration": "m/s^2", "linear": "m/s", "angular": "rad/s",
}  # fmt: skip
_JOINT = {"position": "rad", "velocity": "rad/s", "effort": "N m"}
_MOST = 64  # numbers of a list that become channels of their own
_TURNS = "joints are read as ones that turn: rad, rad/s and N m; for one that slides, type its units"


def robot_library(name: str, what: str) -> Any:
    """A library of the extra [robot], or the error that says what to type."""
    return library(name, what, "robot")


class Topics:
    """Numbers of messages by their names, each with the times at which it came."""

    def __init__(self, allowance: Allowance):
        self.allowance, self.joints = allowance, False
        self.numbers: dict[str, dict[str, tuple[list[float], list[float], str | None]]] = {}

    def add(self, topic: str, time: float, message: Any) -> None:
        """A message that came at a time [s]."""
        fields = _fields(message)
        stamped = _stamp(fields.get("header"))
        for name, value, unit in self._flat(fields):
            times, values, _ = self.numbers.setdefault(topic, {}).setdefault(name, ([], [], unit))
            self.allowance.take(64, "the messages")
            times.append(time if stamped is None else stamped)
            values.append(value)

    def _flat(self, fields: Mapping[str, Any]) -> Iterator[tuple[str, float, str | None]]:
        names = fields.get("name")
        if isinstance(names, (list, tuple)) and set(_JOINT) & set(fields):
            self.joints = True
            for what, unit in _JOINT.items():
                for joint, value in zip(names, np.ravel(fields.get(what, ())), strict=False):
                    yield f"{joint}.{what}", float(value), unit
            return
        yield from _leaves("", fields, None)

    def raw(self, what: str, notes: Sequence[str] = ()) -> Raw:
        """The channels; those of one topic share its times. `notes` say what was left out."""
        raw = Raw(what)
        if not self.numbers:
            raise InputError("read", ["; ".join([f"no message of the {what} holds numbers that can be read", *notes])])
        first = min(times[0] for topic in self.numbers.values() for times, _, _ in topic.values())
        for topic, named in self.numbers.items():
            axes: dict[tuple[float, ...], RawColumn] = {}
            for name, (times, values, unit) in named.items():
                key = (len(times), times[0], times[-1])
                axis = axes.setdefault(key, RawColumn("time", "s", np.array(times) - first))
                called = name if len(self.numbers) == 1 else f"{topic.strip('/')}.{name}"
                raw.columns.append(RawColumn(called, unit or unit_of_heading(name)[1], np.array(values), axis))
        raw.notes += [*notes, *([_TURNS] if self.joints else [])]
        return raw


def _fields(message: Any) -> Mapping[str, Any]:
    """A message as names and values."""
    return (
        message if isinstance(message, Mapping) else {name: getattr(message, name) for name in getattr(message, "__dataclass_fields__", {})}
    )


def _stamp(header: Any) -> float | None:
    """The time in a header; None where there is none, or nobody set it."""
    stamp = _fields(_fields(header).get("stamp")) if header is not None else {}
    seconds = stamp.get("sec", stamp.get("secs"))
    if seconds is None:
        return None
    return float(seconds) + 1e-9 * float(stamp.get("nanosec", stamp.get("nsec", stamp.get("nsecs", 0)))) or None


def _leaves(path: str, value: Any, unit: str | None) -> Iterator[tuple[str, float, str | None]]:
    """The numbers within a message, by the names that lead to them."""
    if isinstance(value, (bool, str, bytes, np.bool_)) or value is None:
        return
    if isinstance(value, (int, float, np.number)):
        yield path or "value", float(value), unit
    elif isinstance(value, (list, tuple, np.ndarray)):
        for k, each in enumerate(value if len(value) <= _MOST else ()):
            yield from _leaves(f"{path}.{k}", each, unit)
    else:
        for name, each in _fields(value).items():
            if name not in ("header", "__msgtype__"):
                yield from _leaves(f"{path}.{name}" if path else name, each, _UNITS.get(name, unit))


# ---- MCAP ----
def parse_mcap(data: bytes, allowance: Allowance) -> Raw:
    """The messages of an MCAP file in JSON, or in the encodings of ROS."""
    reader, topics = robot_library("mcap.reader", "MCAP"), Topics(allowance)
    strange: dict[str, str] = {}
    with damage_reported("MCAP"):
        stores: dict[int, Any] = {}
        for schema, channel, message in reader.make_reader(io.BytesIO(data)).iter_messages():
            if channel.message_encoding == "json":
                topics.add(channel.topic, 1e-9 * message.log_time, json.loads(message.data))
            elif schema is not None and channel.message_encoding in ("cdr", "ros1") and schema.encoding in ("ros2msg", "ros1msg"):
                if schema.id not in stores:
                    stores[schema.id] = _decoder(schema.name, schema.data.decode(), channel.message_encoding)
                topics.add(channel.topic, 1e-9 * message.log_time, stores[schema.id](message.data))
            else:
                strange[channel.topic] = channel.message_encoding
    return topics.raw(
        "MCAP", [f"{name} left out: messages in {how!r} are not read; JSON and those of ROS are" for name, how in strange.items()]
    )


def _decoder(name: str, definition: str, encoding: str) -> Any:
    """What makes a message of bytes, by its definition in the file."""
    typesys = robot_library("rosbags.typesys", "ROS")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE if encoding == "cdr" else typesys.Stores.ROS1_NOETIC)
    full = name if "/msg/" in name else name.replace("/", "/msg/", 1)
    known = typesys.get_types_from_msg(definition, full)
    store.register({each: of for each, of in known.items() if each not in store.fielddefs})
    return lambda data: (store.deserialize_cdr if encoding == "cdr" else store.deserialize_ros1)(data, full)


# ---- bags ----
def parse_bag(data: bytes, allowance: Allowance) -> Raw:
    """The messages of a bag of ROS 1 (.bag)."""
    highlevel, topics = robot_library("rosbags.highlevel", "ROS bag"), Topics(allowance)
    with damage_reported("ROS bag"), tempfile.TemporaryDirectory() as folder:
        path = write_whole(Path(folder) / "log.bag", data, unwritable("read"))
        with highlevel.AnyReader([path]) as reader:
            for connection, time, message in reader.messages():
                topics.add(connection.topic, 1e-9 * time, reader.deserialize(message, connection.msgtype))
    return topics.raw("ROS bag")


# ---- Parquet ----
def parse_parquet(data: bytes, allowance: Allowance, number: int | None = None) -> Raw:
    """The columns of a table in Parquet; lists of numbers, as LeRobot has states and actions, become columns of their own."""
    parquet = robot_library("pyarrow.parquet", "Parquet")
    with damage_reported("Parquet"):
        file = parquet.ParquetFile(io.BytesIO(data))
        described = file.metadata
        allowance.take(sum(described.row_group(k).total_byte_size for k in range(described.num_row_groups)), "the table")
        table, raw = file.read(), Raw("Parquet", table=True)
        for name in table.column_names:
            _add(raw, name, table.column(name))
    if not raw.columns:
        raise InputError("read", ["the Parquet file holds no column of numbers"])
    return _one_episode(raw, number)


def _add(raw: Raw, name: str, column: Any) -> None:
    kind = str(column.type)
    if kind.startswith(("float", "double", "int", "uint")):
        raw.columns.append(RawColumn(name, "s" if name == "timestamp" else unit_of_heading(name)[1], np.asarray(column.to_numpy(), float)))
    elif kind.startswith(("list", "fixed_size_list", "large_list")) and any(number in kind for number in ("float", "double", "int")):
        rows = column.to_pylist()
        width = max((len(row) for row in rows if row is not None), default=0)
        for k in range(min(width, _MOST)):
            values = [float(row[k]) if row is not None and len(row) > k and row[k] is not None else np.nan for row in rows]
            raw.columns.append(RawColumn(f"{name}.{k}", None, np.array(values)))
    elif kind.startswith("timestamp"):
        seconds = np.asarray(column.to_numpy(), "datetime64[ns]").astype("int64") * 1e-9
        raw.columns.append(RawColumn(name, "s", seconds - seconds[0]))
    else:
        raw.notes.append(f"{name} left out: values of {kind} are not numbers")


def _one_episode(raw: Raw, number: int | None) -> Raw:
    """An episode of a table of several, by default the first: each counts its times anew."""
    episode = next((c.values for c in raw.columns if c.name == "episode_index"), None)
    if episode is None:
        if number is not None:
            raise InputError("read", [f"episode = {number!r}; the table has no episodes; leave it out"])
        return raw
    counts = ("frame_index", "episode_index", "index", "task_index")
    there = np.unique(episode)
    if number is not None and number not in there:
        raise InputError("read", [f"episode = {number!r}; allowed are those of the table, {there[0]:.0f} to {there[-1]:.0f}"])
    own = episode == (episode[0] if number is None else number)
    raw.columns = [
        RawColumn(c.name, c.unit, c.values[own], role="" if c.name.startswith("action") else c.role)
        for c in raw.columns
        if c.name not in counts
    ]
    if len(there) > 1 and number is None:
        others = f"the others are episode={there[1]:.0f}" + (f" to {there[-1]:.0f}" if len(there) > 2 else "")
        raw.notes.append(f"of {len(there)} episodes the first is read, {int(own.sum())} of {len(own)} rows; {others}")
    return raw
