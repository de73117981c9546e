"""Image points as packets of the Crazyflie's app channel, and the camera's images as a stream.

The packets are those of `NAME_observe.h` of an exported package. Flying needs cflib and opencv:

    python packets.py radio://0/80/2M/E7E7E7E7E7 192.168.4.1 camera.toml
"""

from __future__ import annotations

import socket
import struct
import sys
import time
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

IN_A_PACKET = 6
"""Points that the 30 bytes of a packet hold."""
SCALE = 8192
LATENCY = 0.06
"""s, from the middle of the exposure until an image is decoded here: measure yours."""


def packets(number: int, age: float, points: Sequence[tuple[float, float]]) -> list[bytes]:
    """Return the packets of an image.

    Parameters
    ----------
    number : int
        Of the image, one more with each.
    age : float
        From the middle of the exposure to sending, s.
    points : sequence of (float, float)
        (x, y) of each target point, focal length 1, in the axes of the body: x forward, y right.
    """
    made = []
    for first in range(0, len(points), IN_A_PACKET):
        part = [c for point in points[first : first + IN_A_PACKET] for c in point]
        if not all(abs(c) < 32767 / SCALE for c in part):
            return []  # beyond what a packet holds: no image
        head = (number % 256, first, min(round(1000 * age), 65535))
        made.append(struct.pack(f"<BBH{len(part)}h", *head, *(round(SCALE * c) for c in part)))
    return made


def in_body(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Turn points of a camera whose image has its top to the front into the axes of the body.

    Parameters
    ----------
    points : sequence of (float, float)
        (u, v), u to the right and v down in the image, focal length 1.
    """
    return [(-v, u) for u, v in points]


def images(host: str, port: int = 5000) -> Iterator[bytes]:
    """Yield the JPEG images that the AI deck sends by WiFi (its example `wifi-img-streamer`).

    Parameters
    ----------
    host : str
        Address of the deck.
    port : int
    """
    with socket.create_connection((host, port), 5) as link:
        whole = link.makefile("rb")
        while True:
            length, _, _ = struct.unpack("<HBB", whole.read(4))
            magic, _, _, _, _, size = struct.unpack("<BHHBBI", whole.read(length - 2))
            if magic != 0xBC:
                continue
            image = b""
            while len(image) < size:
                length, _, _ = struct.unpack("<HBB", whole.read(4))
                image += whole.read(length - 2)
            yield image


def main(uri: str, host: str, camera: Path) -> None:
    """Find the tag in each image, and send its corners until the stream ends."""
    import cflib.crtp
    import cv2
    import numpy as np
    from cflib.crazyflie.syncCrazyflie import SyncCrazyflie

    told: dict[str, Any] = tomllib.loads(camera.read_text())
    matrix, bent = np.array(told["matrix"]), np.array(told["distortion"])
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    finder = cv2.aruco.ArucoDetector(family)
    cflib.crtp.init_drivers()
    with SyncCrazyflie(uri) as vehicle:
        for number, jpeg in enumerate(images(host)):
            begin = time.monotonic()
            image = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
            corners, names, _ = finder.detectMarkers(image)
            if names is None or told["tag"] not in names:
                continue  # no packet: the image on board grows old, and PID flies
            of_tag = corners[[int(n[0]) for n in names].index(told["tag"])]
            seen = cv2.undistortPoints(of_tag.reshape(-1, 1, 2), matrix, bent).reshape(-1, 2)
            age = LATENCY + time.monotonic() - begin
            for packet in packets(number, age, in_body([(float(u), float(v)) for u, v in seen])):
                vehicle.cf.appchannel.send_packet(packet)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], Path(sys.argv[3]))
