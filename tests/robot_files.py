"""Small logs of robots, as their recorders write them; each needs the library of its format."""

import contextlib
import json
import sqlite3

import numpy as np

COUNT = 60


def bam(count=COUNT, **more):
    """A log of BAM's pendulum bench; with ``dt=`` one that was resampled, without times."""
    k = np.arange(count)
    rows = [
        {
            "position": 0.01 * i,
            "speed": 1.0,
            "load": 0.1,
            "input_volts": 15.0,
            "temp": 30,
            "goal_position": 0.01 * i + 0.02,
            "torque_enable": True,
        }
        for i in k.tolist()
    ]
    if "dt" not in more:
        rows = [row | {"timestamp": 0.01 * i} for i, row in enumerate(rows)]
    bench = {"mass": 0.567, "length": 0.105, "kp": 8, "vin": 15.0, "motor": "mx106", "trajectory": "sin_sin"}
    return json.dumps(bench | more | {"entries": rows}).encode()


def mcap_of_json(path):
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("Servo", "jsonschema", b"{}")
        channel = writer.register_channel(topic="/servo", message_encoding="json", schema_id=schema)
        for k in range(COUNT):
            data = json.dumps({"pos_deg": 0.5 * k, "torque_Nm": 0.1, "ok": True}).encode()
            writer.add_message(channel, log_time=10_000_000 * k, publish_time=0, data=data)
        writer.finish()


def mcap_of_ros2(path):
    from mcap.writer import Writer
    from rosbags.typesys import Stores, get_typestore

    name, store = "sensor_msgs/msg/JointState", get_typestore(Stores.ROS2_HUMBLE)
    state, header, time = (store.types[each] for each in (name, "std_msgs/msg/Header", "builtin_interfaces/msg/Time"))
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(name, "ros2msg", store.generate_msgdef(name, ros_version=2)[0].encode())
        channel = writer.register_channel(topic="/joint_states", message_encoding="cdr", schema_id=schema)
        for k in range(COUNT):
            stamp = time(k // 50, 20_000_000 * (k % 50))  # by which the log's own times are not
            message = state(header(stamp, ""), ["hip"], np.array([0.01 * k]), np.array([0.5]), np.array([0.2]))
            writer.add_message(channel, log_time=10_000_000 * k, publish_time=0, data=bytes(store.serialize_cdr(message, name)))
        writer.finish()


def bag(path):
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    stamped, wrench, vector = (store.types[f"geometry_msgs/msg/{each}"] for each in ("WrenchStamped", "Wrench", "Vector3"))
    header, time = store.types["std_msgs/msg/Header"], store.types["builtin_interfaces/msg/Time"]
    with Writer(path) as writer:
        connection = writer.add_connection("/ft", stamped.__msgtype__, typestore=store)
        for k in range(COUNT):
            message = stamped(header(k, time(1, 10_000_000 * k), ""), wrench(vector(0.1 * k, 0.0, 1.0), vector(0.0, 0.0, 0.3)))
            writer.write(connection, 10_000_000 * k, store.serialize_ros1(message, stamped.__msgtype__))


def bag_of_ros2(path):
    """As `ros2 bag record --storage sqlite3` writes it, with a topic of a type that it defines, and one of a type that nobody knows."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store, name, own = get_typestore(Stores.ROS2_HUMBLE), "sensor_msgs/msg/JointState", "rig_msgs/msg/Pad"
    state, header, time = (store.types[each] for each in (name, "std_msgs/msg/Header", "builtin_interfaces/msg/Time"))
    store.register(get_types_from_msg("float64 force\n", own))
    with contextlib.closing(sqlite3.connect(path)) as file:
        file.execute(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)"
        )
        file.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        file.execute(
            "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT, encoding TEXT, encoded_message_definition TEXT)"
        )
        file.execute("INSERT INTO message_definitions VALUES(1, ?, 'ros2msg', 'float64 force\n')", (own,))
        kinds = ("/joint_states", name), ("/pad", own), ("/camera", "vendor_msgs/msg/Frame")
        file.executemany("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", [(k, *each) for k, each in enumerate(kinds, start=1)])
        for k in range(COUNT):
            message = state(
                header(time(k // 50, 20_000_000 * (k % 50)), ""), ["hip"], np.array([0.01 * k]), np.array([0.5]), np.array([0.2])
            )
            pad = store.types[own](0.1 * k)
            rows = [(1, store.serialize_cdr(message, name)), (2, store.serialize_cdr(pad, own)), (3, b"?")]
            file.executemany(
                "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", [(n, 20_000_000 * k, bytes(data)) for n, data in rows]
            )
        file.commit()


def lerobot(path):
    import pyarrow
    import pyarrow.parquet

    k = np.arange(COUNT)
    columns = {"observation.state": [[0.1 * i, 0.2] for i in k], "action": [[0.1 * i, 0.3] for i in k], "timestamp": (k % 30) / 30.0}
    columns |= {"frame_index": k % 30, "episode_index": k // 30, "task": ["go"] * COUNT}
    pyarrow.parquet.write_table(pyarrow.table(columns), path)


WRITERS = {"json.mcap": mcap_of_json, "ros2.mcap": mcap_of_ros2, "ft.bag": bag, "rig.db3": bag_of_ros2, "episodes.parquet": lerobot}
#: The library without which there is no file of a format.
LIBRARIES = {"MCAP": "mcap", "ROS bag": "rosbags", "ROS 2 bag": "rosbags", "Parquet": "pyarrow"}
