"""Logs of autopilots and bags, written as they write them."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

FLIP = np.array([1.0, -1.0, -1.0])
APRILTAG = """
std_msgs/Header header
apriltag_msgs/AprilTagDetection[] detections
================================================================================
MSG: apriltag_msgs/AprilTagDetection
string family
int32 id
int32 hamming
float32 goodness
float32 decision_margin
apriltag_msgs/Point centre
apriltag_msgs/Point[4] corners
float64[9] homography
================================================================================
MSG: apriltag_msgs/Point
float64 x
float64 y
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
TARGET = """
std_msgs/Header header
uint8 IGNORE_ROLL_RATE=1
uint8 type_mask
geometry_msgs/Quaternion orientation
geometry_msgs/Vector3 body_rate
float32 thrust
"""


def message(kind, content):
    """Return a message of a .ulg."""
    return struct.pack("<HB", len(content), ord(kind)) + content


def ulog(path, topics, sync=0):
    """Write a log of PX4: by topic, the names of its fields and rows (time in s, floats).

    With `sync`, a mark to go on from after damage stands after so many rows.
    """
    content = [b"ULog\x01\x12\x35\x01", struct.pack("<Q", 0), message("B", bytes(40))]
    for name, (fields, _) in topics.items():
        words = "".join(f"float{size} {field};" for field, size in fields)
        content.append(message("F", f"{name}:uint64_t timestamp;{words}".encode()))
    for number, name in enumerate(topics):
        content.append(message("A", struct.pack("<BH", 0, number) + name.encode()))
    rows = []
    for number, (_, table) in enumerate(topics.values()):
        for time, *values in table:
            row = struct.pack(f"<HQ{len(values)}f", number, round(1e6 * time), *values)
            rows.append((time, message("D", row)))
    rows.sort(key=lambda row: row[0])
    for k, (_, row) in enumerate(rows):
        content.append(row)
        if sync and k % sync == 0:
            content.append(message("S", b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"))
    Path(path).write_bytes(b"".join(content))
    return path


LETTERS = {"Q": "Q", "f": "f", "B": "B", "c": "h", "C": "H", "I": "I", "M": "B", "h": "h"}
HUNDREDTHS = "cC"
FORMAT_OF_FORMATS = b"\xa3\x95\x80" + struct.pack(
    "<BB4s16s64s", 128, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns"
)


def layout(number, name, letters, columns):
    """Return a message FMT of a .bin, as ArduPilot begins its logs with."""
    length = 3 + struct.calcsize("<" + "".join(LETTERS[c] for c in letters))
    return b"\xa3\x95\x80" + struct.pack(
        "<BB4s16s64s", number, length, name.encode(), letters.encode(), columns.encode()
    )


def dataflash(path, kinds):
    """Write a log of ArduPilot: by kind, letters, columns, and rows (TimeUS in s)."""
    content = [FORMAT_OF_FORMATS]
    rows = []
    for number, (name, (letters, columns, table)) in enumerate(kinds.items(), start=129):
        content.append(layout(number, name, letters, columns))
        pack = struct.Struct("<3s" + "".join(LETTERS[c] for c in letters)).pack
        head = b"\xa3\x95" + bytes([number])
        for row in table:
            stored = [round(1e6 * row[0])]
            for letter, value in zip(letters[1:], row[1:], strict=True):
                times = 100 if letter in HUNDREDTHS else 1
                stored.append(float(value) if letter == "f" else round(times * value))
            rows.append((row[0], pack(head, *stored)))
    rows.sort(key=lambda row: row[0])
    Path(path).write_bytes(b"".join([*content, *(row for _, row in rows)]))
    return path


def quaternions(rotation):
    """Return quaternions, scalar first, of rotations."""
    from scipy.spatial.transform import Rotation

    return np.roll(Rotation.from_matrix(rotation).as_quat(), 1, axis=1)


class Bag:
    """A bag that is written, with rosbags, as a recorder of ROS 2 does."""

    def __init__(self, path, plugin="mcap"):
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.store = get_typestore(Stores.ROS2_HUMBLE)
        self.store.register(
            get_types_from_msg(APRILTAG, "apriltag_msgs/msg/AprilTagDetectionArray")
        )
        self.store.register(get_types_from_msg(TARGET, "mavros_msgs/msg/AttitudeTarget"))
        self.writer = Writer(path, version=9, storage_plugin=StoragePlugin[plugin.upper()])
        self.connections = {}

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *error):
        self.writer.close()

    def make(self, name, *parts):
        """Return a message of a type."""
        return self.store.types[name](*parts)

    def header(self, time, frame=""):
        """Return a header of a time, s."""
        stamp = self.make("builtin_interfaces/msg/Time", int(time), round(time % 1 * 1e9))
        return self.make("std_msgs/msg/Header", stamp, frame)

    def vector(self, v):
        """Return a vector, in axes whose third is up, of one in axes whose third is down."""
        return self.make("geometry_msgs/msg/Vector3", *map(float, FLIP * v))

    def write(self, topic, at, sent):
        """Write a message that comes in at a time, s."""
        kind = sent.__msgtype__
        if topic not in self.connections:
            added = self.writer.add_connection(topic, kind, typestore=self.store)
            self.connections[topic] = added
        data = self.store.serialize_cdr(sent, kind)
        self.writer.write(self.connections[topic], round(at * 1e9), data)

    def imu(self, topic, time, rate, force):
        """Write body rates and specific force."""
        none, unknown = np.zeros(9), np.r_[-1.0, np.zeros(8)]
        level = self.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
        parts = (level, unknown, self.vector(rate), none, self.vector(force), none)
        self.write(topic, time, self.make("sensor_msgs/msg/Imu", self.header(time), *parts))

    def pose(self, position, q):
        """Return a pose."""
        w, *xyz = q
        turned = self.make("geometry_msgs/msg/Quaternion", *map(float, FLIP * xyz), float(w))
        place = self.make("geometry_msgs/msg/Point", *map(float, FLIP * position))
        return self.make("geometry_msgs/msg/Pose", place, turned)

    def odometry(self, topic, time, frame, position, q, velocity):
        """Write a pose and a velocity."""
        twist = self.make("geometry_msgs/msg/Twist", self.vector(velocity), self.vector(FLIP * 0))
        pose = self.make(
            "geometry_msgs/msg/PoseWithCovariance", self.pose(position, q), np.zeros(36)
        )
        moved = self.make("geometry_msgs/msg/TwistWithCovariance", twist, np.zeros(36))
        header = self.header(time, frame)
        self.write(
            topic, time, self.make("nav_msgs/msg/Odometry", header, "base_link", pose, moved)
        )

    def feature(self, topic, at, exposure, feature):
        """Write a feature that comes in at a time."""
        parts = self.header(exposure), self.vector(feature)
        self.write(topic, at, self.make("geometry_msgs/msg/Vector3Stamped", *parts))

    def thrust(self, topic, time, thrust):
        """Write a thrust that is asked for, N."""
        wrench = self.make(
            "geometry_msgs/msg/Wrench",
            self.vector(np.array([0, 0, -thrust])),
            self.vector(np.zeros(3)),
        )
        parts = self.header(time), wrench
        self.write(topic, time, self.make("geometry_msgs/msg/WrenchStamped", *parts))

    def rotors(self, topic, time, thrusts):
        """Write what is asked of each rotor, N."""
        none = np.zeros(0)
        names = [f"rotor_{k}" for k in range(len(thrusts))]
        parts = self.header(time), names, none, none, np.asarray(thrusts, float)
        self.write(topic, time, self.make("sensor_msgs/msg/JointState", *parts))

    def rates(self, topic, time, rate):
        """Write rates that are asked for, as MAVROS takes them."""
        level = self.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
        parts = self.header(time), 128, level, self.vector(rate), 0.5
        self.write(topic, time, self.make("mavros_msgs/msg/AttitudeTarget", *parts))

    def sightings(self, topic, at, exposure, count):
        """Write tags that were found in an image."""
        kind = "apriltag_msgs/msg/AprilTagDetection"
        point = self.make("apriltag_msgs/msg/Point", 1.0, 2.0)
        tag = self.make(kind, "36h11", 0, 0, 0.0, 50.0, point, [point] * 4, np.zeros(9))
        parts = self.header(exposure), [tag] * count
        self.write(topic, at, self.make("apriltag_msgs/msg/AprilTagDetectionArray", *parts))


def bag_of(log, path, plugin="mcap", begin=10.0):
    """Write a log of a flight of ours as the bag that a vehicle under ROS 2 would leave."""
    own, times = "/hoverproof/", log.times + begin
    q = quaternions(log.rotation)
    exposed = times - log.image_age
    with Bag(path, plugin) as bag:
        for k, time in enumerate(times):
            sent = times[k - 1] if k else 2 * times[0] - times[1]  # a row has what was asked before
            bag.imu("/imu/data", time, log.rate[k], log.specific_force[k])
            bag.odometry("/odom", time, "target", log.position[k], q[k], log.velocity[k])
            bag.thrust(own + "thrust", sent, log.thrust_command[k])
            bag.rotors(own + "rotors", sent, log.rotor_command[k])
            bag.feature(own + "feature", sent, exposed[k], log.feature[k])
            if not k or exposed[k] > exposed[k - 1] + 1e-6:
                bag.sightings("/detections", sent, exposed[k], 1)
    return path
