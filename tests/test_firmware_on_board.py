"""The exported C flies on an emulated board: each step there, the vehicle and its sensors here."""

from __future__ import annotations

import numpy as np
import pytest

import hoverproof
from board_kit import listen, on_board
from firmware_kit import BOARDS, Package, tool
from hoverproof.export.binding import Firmware
from hoverproof.mission.reading import load
from test_real_vehicle import IMAGE, LAW, REAL, VEHICLE, mean_end, settled_before

pytestmark = pytest.mark.slow

M4F, M7 = BOARDS["Cortex-M4F"], BOARDS["Cortex-M7"]


@pytest.fixture
def real_vehicle(tmp_path):
    """Return the vehicle of 0.5 kg with sensors, slow rotors, wind and errors of the model."""
    path = tmp_path / "small.toml"
    path.write_text(VEHICLE)
    return lambda law: load(path, law | REAL)


def exported(mission, folder, precision="float32"):
    tool("cc"), tool("arm-none-eabi-gcc"), tool("qemu-system-arm")
    options = {"camera": True, "allow_uncertified": True, "precision": precision}
    return Package(folder, hoverproof.export_c(mission, folder, **options))


def flights(mission, package, board, *flags, duration=10):
    """Return a flight of the C here and one of the C on a board, and all that each was told."""
    here = Firmware(package.folder)
    with on_board(board, package, *flags) as there:
        heard = listen(here), listen(there)
        flown = [
            hoverproof.fly_firmware(mission, firmware, duration=duration, every=1, seed=1)
            for firmware in (here, there)
        ]
    return flown, heard


@pytest.mark.parametrize(
    ("law", "precision", "board"),
    [
        (LAW, "float32", M4F),
        pytest.param(LAW, "float32", M7, marks=pytest.mark.whole),
        pytest.param(LAW, "float64", M7, marks=pytest.mark.whole),
        pytest.param(IMAGE, "float32", M4F, marks=pytest.mark.whole),
    ],
)
def test_on_a_board_it_flies_the_very_flight_that_it_flies_here(
    law, precision, board, real_vehicle, tmp_path
):
    """Weak, heavy, in wind and with late frames; every input, output and state at every tick."""
    mission = real_vehicle(law)
    package = exported(mission, tmp_path / "fw", precision)
    (here, there), (told_here, told_there) = flights(mission, package, board)
    assert len(told_there) == 1 + 10 * 250
    assert len(set(told_there)) == len(told_there)
    assert told_there == told_here
    assert here.equals(there)
    assert there.attrs["outcome"] == "flown"
    if law == LAW:
        assert settled_before(there, [0, 0, -1.2], 3)
        assert np.linalg.norm(mean_end(there) - [0, 0, -1.2]) < 0.02


def test_on_a_board_the_law_of_the_paper_flies_the_same_flight_too(tmp_path):
    mission = load("x4-flyer", {"sensors": "{control_rate = 100}"})
    package = exported(mission, tmp_path / "fw")
    (here, there), (told_here, told_there) = flights(mission, package, M4F)
    assert len(told_there) == 1 + 10 * 100
    assert told_there == told_here
    assert here.equals(there)
    far = np.linalg.norm(there["position"].values - there["position"].values[-1], axis=1)
    assert far[0] > 0.1


def test_on_a_board_told_to_fuse_products_it_is_the_same_flight(real_vehicle, tmp_path):
    """The exported C forbids it; without that, it was another."""
    mission = real_vehicle(LAW)
    package = exported(mission, tmp_path / "fw")
    (here, there), (told_here, told_there) = flights(
        mission, package, M4F, "-ffp-contract=fast", duration=0.5
    )
    assert told_there == told_here
    assert here.equals(there)
