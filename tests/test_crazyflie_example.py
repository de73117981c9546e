"""A walk through a Crazyflie with an AI deck: its commands make its files, packets are taken in."""

from __future__ import annotations

import importlib.util
import re
import shlex
import socket
import struct
import threading
from pathlib import Path

import pytest

from firmware_kit import run
from hoverproof.cli import main
from test_firmware_autopilots import best, crazyflie

HERE = Path(__file__).parents[1] / "examples" / "crazyflie-ai-deck"
README = (HERE / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def stream():
    spec = importlib.util.spec_from_file_location("packets", HERE / "packets.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_export_makes_each_file_that_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (command,) = re.findall(r"^hoverproof (export .*)$", README, re.M)
    with pytest.raises(SystemExit) as done:
        main(shlex.split(command))
    assert done.value.code == 0
    named = set(re.findall(r"`(law/[\w/.]+)`", README))
    assert len(named) >= 5
    assert {path for path in named if not (tmp_path / path).is_file()} == set()
    own = set(re.findall(r"`(\w+\.(?:py|toml))`", README))
    assert own == {path.name for path in HERE.iterdir()} - {"README.md", "__pycache__"}


@pytest.mark.slow
def test_its_packets_are_images_to_the_controller(stream, tmp_path):
    package = best(tmp_path / "fw")
    program = crazyflie(package, tmp_path)
    points = stream.in_body([(0.1, -0.2), (0.3, 0.4), (-0.5, 0.6), (-0.7, -0.8)])
    (packet,) = stream.packets(300, 0.075, points)
    assert len(packet) == 20
    taken, age, *seen = run(program, "packets", packet.hex()).stdout.split()
    assert taken == "1"
    assert float(age) == pytest.approx(0.075)
    wanted = [0.2, 0.1, -0.4, 0.3, -0.6, -0.5, 0.8, -0.7]
    assert [float(c) for c in seen] == pytest.approx(wanted, abs=1e-4)


def test_many_points_are_parted_and_one_that_no_packet_holds_is_no_image(stream):
    parts = stream.packets(1, 0.05, [(0.1, 0.2)] * 8)
    assert [len(part) for part in parts] == [28, 12]
    assert [part[1] for part in parts] == [0, 6]
    assert stream.packets(1, 0.05, [(0.1, 4.0)]) == []


def test_an_image_of_the_stream_comes_in_parts(stream):
    def packet(body):
        return struct.pack("<HBB", len(body) + 2, 0, 0) + body

    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        link, _ = server.accept()
        for jpeg in (b"first" * 100, b"second"):
            link.sendall(packet(struct.pack("<BHHBBI", 0xBC, 324, 244, 1, 1, len(jpeg))))
            for at in range(0, len(jpeg), 200):
                link.sendall(packet(jpeg[at : at + 200]))
        link.close()

    thread = threading.Thread(target=serve)
    thread.start()
    frames = stream.images("127.0.0.1", server.getsockname()[1])
    assert [next(frames), next(frames)] == [b"first" * 100, b"second"]
    thread.join()
    server.close()
