"""Read bags of ROS 2, MCAP or SQLite, with rosbags: ROS has z up, here it is down."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.log import FlightLog
from hoverproof.audit.tracks import EVER, Tracks, log_of
from hoverproof.errors import InputError, in_short, needing, suggestion

Array = NDArray[np.float64]
Row = tuple[float, tuple[float, ...]]

ENDINGS = (".mcap", ".db3")
OWN = "/hoverproof/"
"""Topics of these names are taken without being named: a type tells little of them."""
TARGET = "target"
"""A frame of this name has its origin in the middle of the target."""
AT_ONCE = 4096
CLOCKS = 5.0
"""Stamps that are off the times of the bag by more are of another clock, s."""


@dataclass(frozen=True)
class Part:
    """A part that a topic plays.

    Attributes
    ----------
    types : tuple of str
        That its messages may have.
    told : bool
        Whether the type alone tells it.
    words : str
        What it would tell.
    """

    types: tuple[str, ...]
    told: bool
    words: str


PARTS = {
    "imu": Part(("sensor_msgs/msg/Imu",), True, "body rates, specific force"),
    "odometry": Part(("nav_msgs/msg/Odometry",), True, "attitude, velocity: wind, replay"),
    "pose": Part(("geometry_msgs/msg/PoseStamped",), False, "position from the target"),
    "feature": Part(("geometry_msgs/msg/Vector3Stamped",), False, "latency, frame gaps, replay"),
    "sightings": Part(
        ("apriltag_msgs/msg/AprilTagDetectionArray", "vision_msgs/msg/Detection2DArray"),
        True,
        "images, whether the target was seen",
    ),
    "rates": Part(
        ("mavros_msgs/msg/AttitudeTarget", "geometry_msgs/msg/TwistStamped"), False, "rate loop"
    ),
    "thrust": Part(("geometry_msgs/msg/WrenchStamped",), False, "thrust gain"),
    "rotors": Part(("sensor_msgs/msg/JointState",), False, "torque gain, rotor lag, each rotor"),
}


def is_bag(path: Path, first: bytes) -> bool:
    """Tell whether a folder or a file is a bag of ROS 2.

    Parameters
    ----------
    path : Path
    first : bytes
        Of a file, 16.
    """
    if path.is_dir():
        return (path / "metadata.yaml").exists()
    return first.startswith((b"\x89MCAP0\r\n", b"SQLite format 3\0"))


def read(path: Path, topics: Mapping[str, str], between: tuple[float, float] = EVER) -> FlightLog:
    """Read a bag.

    Parameters
    ----------
    path : Path
        Its folder, or its one file.
    topics : mapping
        Topic by part, where the type does not tell it.
    between : (2,)
        s: what is not is left out.

    Raises
    ------
    InputError
        If rosbags is not there, a topic is not, or nothing of a flight can be read.
    """
    with needing("logs", str(path), "needs rosbags to be read"):
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    if path.is_file() and path.suffix not in ENDINGS:
        raise InputError(str(path), "", "is a bag of ROS 2, whose name must end in .mcap or .db3")
    bag = Bag(str(path), Tracks(between))
    try:
        reader = AnyReader([path], default_typestore=get_typestore(Stores.LATEST))
        reader.open()
    except Exception as error:  # rosbags raises what struct, sqlite and its own parsers do
        raise InputError(str(path), "", f"is damaged or cut short: {in_short(error)}") from None
    try:
        connections = bag.chosen(reader.connections, topics)
        bag.take(reader, connections)
    finally:
        reader.close()
    return bag.log()


@dataclass
class Bag:
    """What is gathered of a bag.

    Attributes
    ----------
    source : str
    tracks : Tracks
    notes, partial : list of str
    """

    source: str
    tracks: Tracks
    notes: list[str] = field(default_factory=list)
    partial: list[str] = field(default_factory=list)
    _rows: dict[str, list[Row]] = field(default_factory=dict)
    _off: list[float] = field(default_factory=list)

    def chosen(self, connections: list[Any], topics: Mapping[str, str]) -> dict[str, list[Any]]:
        """Return the connections of each part.

        Parameters
        ----------
        connections : list
        topics : mapping

        Raises
        ------
        InputError
            If a topic is not there or has another type, or several might be meant.
        """
        there = {c.topic: c.msgtype for c in connections}
        names: dict[str, str] = {}
        for part, topic in topics.items():
            if part not in PARTS:
                raise InputError(f"--topic {part}", "", suggestion(part, [*PARTS], "there are"))
            if topic not in there:
                reason = suggestion(topic, [*there], "the bag has")
                raise InputError(self.source, "", f"holds no topic {topic}: {reason}")
            if there[topic] not in PARTS[part].types:
                reason = f"is {there[topic]}, not {' or '.join(PARTS[part].types)}"
                raise InputError(self.source, "", f"topic {topic} {reason}")
            names[part] = topic
        for part, rule in PARTS.items():
            fits = sorted(name for name, kind in there.items() if kind in rule.types)
            own = [name for name in fits if name == OWN + part]
            fits = own or (fits if rule.told else [])
            if len(fits) > 1 and part not in names:
                reason = f"has several topics of {part}: {', '.join(fits)[:200]}"
                raise InputError(self.source, "", f"{reason}: say which by --topic {part}=NAME")
            if fits:
                names.setdefault(part, fits[0])
        return {p: [c for c in connections if c.topic == name] for p, name in names.items()}

    def take(self, reader: Any, chosen: Mapping[str, list[Any]]) -> None:
        """Go through the messages.

        Parameters
        ----------
        reader : AnyReader
        chosen : mapping
            Connections by part.
        """
        parts = {c.topic: part for part, connections in chosen.items() for c in connections}
        if not parts:
            return
        try:
            for connection, at, data in reader.messages([*itertools.chain(*chosen.values())]):
                message = reader.deserialize(data, connection.msgtype)
                for name, row in READERS[parts[connection.topic]](self, message, at / 1e9):
                    self._put(name, row)
        except Exception as error:  # rosbags raises what struct, sqlite and its own parsers do
            self.partial.append(f"it is damaged or cut short: {in_short(error)}")
        for name in self._rows:
            self._flush(name)

    def _put(self, name: str, row: Row) -> None:
        rows = self._rows.setdefault(name, [])
        rows.append(row)
        if len(rows) >= AT_ONCE:
            self._flush(name)

    def _flush(self, name: str) -> None:
        rows, self._rows[name] = self._rows[name], []
        width = len(rows[0][1]) if rows else 0
        rows = [row for row in rows if len(row[1]) == width]
        if rows:
            times, values = zip(*rows, strict=True)
            self.tracks.add(name, np.array(times), np.array(values, np.float64))

    def _imu(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield what a message of the inertial sensors tells, which came in at a time, s."""
        time, turn = _stamp(message), _turn(message)
        if len(self._off) < AT_ONCE:
            self._off.append(at - time)
        yield "rate", (time, turn(message.angular_velocity))
        yield "specific_force", (time, turn(message.linear_acceleration))
        if message.orientation_covariance[0] != -1:
            yield "imu attitude", (time, _quaternion(message.orientation, turn))

    def _odometry(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield what a message of the odometry tells."""
        time, turn = _stamp(message), _turn(message)
        pose, frame = message.pose.pose, message.header.frame_id
        yield "attitude", (time, _quaternion(pose.orientation, turn))
        yield "velocity", (time, turn(message.twist.twist.linear))
        if frame == TARGET:
            yield "odometry position", (time, turn(pose.position))

    def _pose(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield what a message of the pose from the target tells."""
        time, turn = _stamp(message), _turn(message)
        yield "position", (time, turn(message.pose.position))
        yield "pose attitude", (time, _quaternion(message.pose.orientation, turn))

    def _feature(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield the feature that came in; its stamp is that of the exposure."""
        yield "feature", (at, (_stamp(message), *_turn(message)(message.vector)))

    def _sightings(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield whether there was something in an image."""
        yield "frames", (_stamp(message), (float(len(message.detections) > 0),))

    def _rates(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield the rates that were asked for."""
        time, turn = _stamp(message), _turn(message)
        if hasattr(message, "body_rate"):
            yield "rate_command", (time, turn(message.body_rate))
            yield "throttle", (time, (float(message.thrust),))
        else:
            yield "rate_command", (time, turn(message.twist.angular))

    def _thrust(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield the thrust that was asked for, N."""
        yield "thrust_command", (_stamp(message), (-_turn(message)(message.wrench.force)[2],))

    def _rotors(self, message: Any, at: float) -> Iterator[tuple[str, Row]]:
        """Yield the thrust that was asked of each rotor, N."""
        if len(message.effort):
            yield "rotor_command", (_stamp(message), tuple(map(float, message.effort)))

    def log(self) -> FlightLog:
        """Return the log."""
        held = self.tracks.held
        for name, others in STAND_IN.items():
            for other in others:
                self.tracks.stand_in(name, other)
        if self._off and abs(float(np.median(self._off))) > CLOCKS and "feature" in held:
            held.pop("feature")
            self.notes.append("its stamps are of another clock than its times: no ages of images")
        if "position" not in held:
            self.notes.append("positions are not told from the target")
        wanted = {name: f"{part}: {PARTS[part].words}" for name, part in MADE_OF.items()}
        return log_of(
            self.tracks,
            self.source,
            "ROS 2 bag",
            rates="topic of sensor_msgs/msg/Imu (--topic imu=NAME)",
            partial=self.partial,
            wanted={name: f"topic {words}" for name, words in wanted.items()},
            notes=tuple(self.notes),
        )


READERS: dict[str, Callable[[Bag, Any, float], Iterator[tuple[str, Row]]]] = {
    "imu": Bag._imu,
    "odometry": Bag._odometry,
    "pose": Bag._pose,
    "feature": Bag._feature,
    "sightings": Bag._sightings,
    "rates": Bag._rates,
    "thrust": Bag._thrust,
    "rotors": Bag._rotors,
}
STAND_IN = {"attitude": ("pose attitude", "imu attitude"), "position": ("odometry position",)}
MADE_OF = {
    "velocity": "odometry",
    "position": "pose",
    "feature": "feature",
    "frames": "sightings",
    "rate_command": "rates",
    "thrust_command": "thrust",
    "rotor_command": "rotors",
}


def _stamp(message: Any) -> float:
    stamp = message.header.stamp
    return float(stamp.sec + stamp.nanosec / 1e9)


def _turn(message: Any) -> Callable[[Any], tuple[float, float, float]]:
    """Return what gives a vector in axes whose third is down; ROS's third is up.

    Both are told by the name of the frame, as MAVROS does: base_link, base_link_frd.
    """
    sign = 1.0 if message.header.frame_id.endswith(("_frd", "_ned")) else -1.0
    return lambda v: (float(v.x), sign * float(v.y), sign * float(v.z))


def _quaternion(q: Any, turn: Callable[[Any], tuple[float, float, float]]) -> tuple[float, ...]:
    return (float(q.w), *turn(q))
