"""Bags of ROS 2 in SQLite (.db3): messages of topics, with the types that the file names; no part of the file is run."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance
from stickslip.records.extras import damage_reported
from stickslip.records.raw import Raw
from stickslip.records.robot_logs import Topics, robot_library

_TABLES = "SELECT name FROM sqlite_master WHERE type = 'table'"  # a view could be made to run for ever
_TOPICS = "SELECT id, name, type, serialization_format FROM topics"
_MESSAGES = "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY timestamp"
_DEFINITIONS = "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = 'ros2msg'"


def parse(data: bytes, allowance: Allowance) -> Raw:
    """The messages of a bag in SQLite."""
    topics, notes, what = Topics(allowance), list[str](), "ROS 2 bag"
    typesys = robot_library("rosbags.typesys", what)
    with damage_reported(what), closing(sqlite3.connect(":memory:")) as file:
        file.deserialize(data)
        file.execute("PRAGMA trusted_schema = OFF")
        tables = {str(name) for (name,) in file.execute(_TABLES)}
        if not {"topics", "messages"} <= tables:
            raise InputError("read", ["the SQLite file is no bag of ROS 2: it has no tables of topics and messages"])
        store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        for name, text in file.execute(_DEFINITIONS) if "message_definitions" in tables else ():
            known = typesys.get_types_from_msg(text, name)
            store.register({each: of for each, of in known.items() if each not in store.fielddefs})
        for number, topic, kind, how in file.execute(_TOPICS).fetchall():
            if how != "cdr" or kind not in store.fielddefs:
                notes.append(f"{topic} left out: messages of the type {kind!r} in {how!r} are not known here")
                continue
            _add(file, store, topics, number, topic, kind)
    return topics.raw(what, notes)


def _add(file: sqlite3.Connection, store: Any, topics: Topics, number: int, topic: str, kind: str) -> None:
    for time, message in file.execute(_MESSAGES, (number,)):
        topics.add(topic, 1e-9 * time, store.deserialize_cdr(message, kind))
