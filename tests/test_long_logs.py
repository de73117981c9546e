"""Logs longer than memory: what is kept of them is bounded, whatever their size."""

from __future__ import annotations

import json
import subprocess
import sys
import tracemalloc
from pathlib import Path

import h5py
import numpy as np
import pytest

from hoverproof.audit import bag, dataflash, own, tracks, ulog
from hoverproof.audit.reading import read_log
from hoverproof.mission.reading import load
from hoverproof.simulation.flight import flown, save
from hoverproof.simulation.timing import Timing
from log_kit import FORMAT_OF_FORMATS, Bag, layout, message

GIGABYTE = 1_000_000_000
BOUND = 300
"""MB of resident memory at most, of which Python with numpy and h5py is a part."""
RATE = 1000
"""Hz."""
FORMATS = ("flight.nc", "log.ulg", "log.bin", "log.mcap")
MEASURE = """
import json, resource, sys
from hoverproof.audit.reading import read_log
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
log = read_log(sys.argv[1])
most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
told = dict(before=before / 1024, most=most / 1024, rows=len(log.times), end=log.times[-1])
print(json.dumps(told | dict(partial=log.partial, notes=log.notes)))
"""


def in_parts(count, at_once=100_000):
    for begin in range(0, count, at_once):
        yield np.arange(begin, min(begin + at_once, count))


def turning(k):
    """Return body rates and specific force, six numbers a row."""
    t = k / RATE
    parts = [np.sin(t), np.cos(t), 0 * t, 0 * t + 0.1, 0 * t, -9.81 + 0.01 * np.sin(t)]
    return np.stack(parts, axis=1).astype("<f4")


def write_ulg(path, size):
    kinds = [("vehicle_angular_velocity", 0), ("vehicle_acceleration", 3), ("battery_status", 0)]
    row = np.dtype(
        [("size", "<u2"), ("kind", "S1"), ("id", "<u2"), ("time", "<u8"), ("xyz", "<f4", 3)]
    )
    with Path(path).open("wb") as file:
        file.write(b"ULog\x01\x12\x35\x01" + bytes(8) + message("B", bytes(40)))
        for name, _ in kinds:
            file.write(message("F", f"{name}:uint64_t timestamp;float[3] xyz;".encode()))
        for number, (name, _) in enumerate(kinds):
            file.write(message("A", bytes([0]) + number.to_bytes(2, "little") + name.encode()))
        for k in in_parts(size // (len(kinds) * row.itemsize)):
            rows = np.zeros((len(k), len(kinds)), row)
            rows["size"], rows["kind"] = row.itemsize - 3, b"D"
            rows["time"] = (1_000_000 // RATE * (k + 1))[:, None]
            for number, (_, begin) in enumerate(kinds):
                rows["id"][:, number] = number
                rows["xyz"][:, number] = turning(k)[:, begin : begin + 3]
            file.write(rows.tobytes())


def write_bin(path, size):
    row = np.dtype([("head", "S3"), ("time", "<u8"), ("I", "u1"), ("xyz", "<f4", 6)])
    columns = "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"
    with Path(path).open("wb") as file:
        file.write(FORMAT_OF_FORMATS)
        file.write(layout(129, "IMU", "QBffffff", columns))
        for k in in_parts(size // row.itemsize):
            rows = np.zeros(len(k), row)
            rows["head"], rows["time"] = b"\xa3\x95\x81", 1_000_000 // RATE * (k + 1)
            rows["xyz"] = turning(k)
            file.write(rows.tobytes())


def write_mcap(path, size):
    """Write one message again and again, with its stamp and rates put into its bytes."""
    folder = Path(path).with_suffix("")
    with Bag(folder) as made:
        made.imu("/imu", 1.0, np.zeros(3), np.array([0, 0, -9.81]))
        connection = made.connections["/imu"]
        first = made.store.serialize_cdr(
            made.make(
                "sensor_msgs/msg/Imu",
                made.header(1.0),
                made.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0),
                np.r_[-1.0, np.zeros(8)],
                made.vector(np.zeros(3)),
                np.zeros(9),
                made.vector(np.array([0, 0, -9.81])),
                np.zeros(9),
            ),
            "sensor_msgs/msg/Imu",
        )
        content = bytearray(first)
        for k in range(1, size // (len(content) + 31)):
            at = 1_000_000_000 + k * (1_000_000_000 // RATE)
            content[4:12] = np.array(divmod(at, 1_000_000_000), "<u4").tobytes()
            made.writer.write(connection, at, content)
    (folder / f"{folder.name}.mcap").rename(path)


def write_nc(path, size):
    """Write a flight of ours again and again, one after the other."""
    short = Path(path).with_name("short.nc")
    save(flown(load("research-1.5kg"), Timing(1, None, None)), short)
    with h5py.File(short) as given, h5py.File(path, "w") as file:
        count = given["time"].shape
        row = sum(data[:1].nbytes for data in given.values() if data.shape[:1] == count)
        times = size // (row * (count[0] - 1)) + 1
        file.attrs.update(given.attrs)
        steps = given["time"][1:]
        for name, data in given.items():
            if data.shape[:1] != count:
                continue
            one = data[1:]
            made = file.create_dataset(name, (times * len(one), *one.shape[1:]), one.dtype)
            for k in range(times):
                part = one + k * (steps[-1]) if name == "time" else one
                made[k * len(one) : (k + 1) * len(one)] = part


WRITE = dict(zip(FORMATS, (write_nc, write_ulg, write_bin, write_mcap), strict=True))


@pytest.mark.parametrize("name", FORMATS)
def test_what_a_log_takes_of_memory_does_not_grow_with_it(name, tmp_path, monkeypatch):
    for module in (own, tracks):
        monkeypatch.setattr(module, "MOST_ROWS", 200)
    monkeypatch.setattr(own, "AT_A_TIME", 50)
    for module in (ulog, dataflash):
        monkeypatch.setattr(module, "PIECE", 1 << 14)
    monkeypatch.setattr(bag, "AT_ONCE", 64)
    peaks, ends = [], []
    few = {"log.mcap": 1_200_000, "flight.nc": 1_000_000}.get(name, 300_000)
    for size in (few, 3 * few):
        folder = tmp_path / str(size)
        folder.mkdir()
        WRITE[name](folder / name, size)
        read_log(folder / name) if not peaks else None  # what is imported and kept once
        tracemalloc.start()
        log = read_log(folder / name)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert 100 <= len(log.times) <= 200
        assert log.partial == ""
        assert "rows of" in " ".join(log.notes)
        ends.append(log.times[-1] - log.times[0])
    assert ends[1] > 2 * ends[0]
    assert peaks[1] < 1.4 * peaks[0]


@pytest.mark.whole
@pytest.mark.parametrize("name", FORMATS)
def test_a_gigabyte_is_read_in_a_third_of_that_at_most(name, tmp_path):
    WRITE[name](tmp_path / name, GIGABYTE)
    assert (tmp_path / name).stat().st_size > 0.9 * GIGABYTE
    words = [sys.executable, "-c", MEASURE, str(tmp_path / name)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    (tmp_path / name).unlink()
    told = json.loads(done.stdout)
    assert told["most"] < BOUND
    assert 100_000 < told["rows"] <= 400_000
    assert not told["partial"]
