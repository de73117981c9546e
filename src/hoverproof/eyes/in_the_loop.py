"""Flights that see by images: rendered where the vehicle is, searched for the tag, and flown on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.eyes.detector import Detector
from hoverproof.eyes.renderer import Image, Pose, Renderer, Shot
from hoverproof.firmware.flying import flown_firmware
from hoverproof.mission.sections import Mission
from hoverproof.mission.tags import Board, board_of_mission
from hoverproof.plant import camera
from hoverproof.plant.lens import seeing_lens
from hoverproof.simulation.flight import SAMPLES, fly_as_built, sample_bytes
from hoverproof.simulation.image_age import age_in_use
from hoverproof.simulation.observed import camera_function, seen_function
from hoverproof.simulation.plan import Plan, check_seed
from hoverproof.simulation.record import Column, Record
from hoverproof.simulation.timing import Timing

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pixels:
    """What images a flight sees by.

    Attributes
    ----------
    board : Board
        What is printed, where the mission's target lies.
    renderer : Renderer
    detector : Detector
    jitter : float
        s: a frame comes later than the latency says by the size of a normal number of this
        standard deviation.
    seed : int
        Of the images' noise and of the jitter, a bare number.
    """

    board: Board
    renderer: Renderer
    detector: Detector
    jitter: float = 0.0
    seed: int = 0

    @classmethod
    def of(
        cls,
        mission: Mission,
        board: Board | None = None,
        shot: Shot | None = None,
        *,
        jitter: float = 0.0,
        seed: int = 0,
    ) -> Pixels:
        """Return the images that the camera of a mission takes.

        Parameters
        ----------
        mission : Mission
            With a lens.
        board : Board, optional
            The tags on its target; see `board_of_mission`.
        shot : Shot, optional
        jitter : float
            s; see above.
        seed : int
            A bare number.

        Raises
        ------
        InputError
            If it has no lens, or the board is not its target.
        """
        seeing = seeing_lens(mission)
        if seeing is None:
            reason = 'is missing: images have pixels; give [camera] file = "camera_info.yaml"'
            raise InputError(mission.source, "camera.lens", reason)
        placed = board_of_mission(mission, board)
        renderer = Renderer(placed, *seeing, shot or Shot(), seed)
        return cls(placed, renderer, Detector(placed, *seeing), jitter, seed)

    def frames(self, mission: Mission, timing: Timing) -> int:
        """Return how many images a flight takes, if it does not end early.

        Parameters
        ----------
        mission : Mission
        timing : Timing
        """
        steps = timing.steps(mission, SAMPLES, sample_bytes(mission), None)
        rate = mission.sensors.frame_rate
        return steps.count if rate is None else math.ceil(steps.count * steps.step * float(rate))


@dataclass
class Eyes:
    """What takes the place of the camera in a flight; see `hoverproof.simulation.kernel.Eyes`.

    Attributes
    ----------
    plan : Plan
    pixels : Pixels
    keep : callable, optional
        Given each image.
    steps : list of int
        Of the frames so far, bare numbers.
    true, found : list of (n, 2) arrays
        Where the target points are in the image, and where they were found, px; not a number of
        a tag that was not found.
    late : list of int
        By how many steps each came later than the latency says, bare numbers.
    """

    plan: Plan
    pixels: Pixels
    keep: Callable[[Image], None] | None = None
    steps: list[int] = field(default_factory=list)
    true: list[Array] = field(default_factory=list)
    found: list[Array] = field(default_factory=list)
    late: list[int] = field(default_factory=list)

    def __call__(
        self, step: int, memory: Array, parameters: Array, noise: Array
    ) -> tuple[Array, Array, int]:
        """Return what a frame tells, a margin above 0 if all of the target is found, and lateness.

        Parameters
        ----------
        step : int
            A bare number.
        memory, parameters, noise
            Of one vehicle; see `kernel.Eyes`.
        """
        plan, pixels = self.plan, self.pixels
        made = plan.numbers.target_size, plan.features, plan.numbers.law, plan.rotors
        looked = camera_function(*made)(memory[:, 0], parameters[0])
        position, rotation, velocity, rate = (np.asarray(part.full()) for part in looked)
        pose = Pose(position.ravel(), rotation, velocity.ravel(), rate.ravel())
        image = pixels.renderer.image(pose, len(self.steps))
        if self.keep is not None:
            self.keep(image)
        order = pixels.board.order
        seen = pixels.detector.corners(image).reshape(-1, 2)[order]
        self.steps.append(step)
        self.true.append(pixels.renderer.pixels(pose).reshape(-1, 2)[order])
        self.found.append(seen)
        late = 0
        if pixels.jitter:
            drawn = np.random.default_rng((pixels.seed, len(self.steps), 1)).standard_normal()
            late = math.ceil(abs(drawn) * pixels.jitter / plan.step)
        self.late.append(late)
        if np.isnan(seen).any():
            size = plan.loop.constants["SEEN"]
            return np.zeros((size, 1)), np.full(1, -1.0), late
        shake = noise[2 * len(order) :] if plan.numbers.law.sees_north else np.zeros(3)
        told = seen_function(*made)(memory, parameters[0], plan.numbers.points, seen.T, shake)
        return np.asarray(told.full()), np.ones(1), late

    def add_to(self, record: Record) -> None:
        """Put what was seen into the record of the flight.

        Parameters
        ----------
        record : Record
        """
        times = self.plan.step * np.array(self.steps)
        record.coordinates["frame"] = Column(("frame",), times, {"units": "s"})
        axes = ("frame", "point", "image_axis")
        for name, values, words in (
            ("pixel_true", self.true, "where a target point is in the image"),
            ("pixel_found", self.found, "where it was found"),
        ):
            record.add(name, axes, np.array(values), units="px", long_name=words)
        feature = look_at(self.plan)
        whole = ~np.isnan(np.array(self.found)).any(axis=(1, 2))
        used = whole | (np.arange(len(times)) == 0)  # at first there is nothing to hold
        taken = np.array(self.steps)[used], np.array(self.late)[used]
        ages = age_in_use(self.plan, record["time"].values, *taken)
        words = "since the exposure of the frame that the controller uses"
        record.add("image_age", ["time"], ages, units="s", long_name=words)
        error = np.full((len(times), 3), np.nan)
        if whole.any():
            told = [each_frame(feature, np.array(s)[whole]) for s in (self.found, self.true)]
            error[whole] = told[0] - told[1]
        words = "feature of the points found less that of the true ones, body axes"
        record.add("feature_error", ("frame", "body_axis"), error, units="1", long_name=words)


def look_at(plan: Plan) -> ca.Function:
    """Return (2, n) px ↦ the feature that the law of a plan makes of it, (3,), body axes.

    Parameters
    ----------
    plan : Plan
        Of a mission with a lens.
    """
    law, lens = plan.numbers.law, seeing_lens(plan.mission)
    assert lens is not None
    image = ca.SX.sym("image", 2, plan.numbers.target_size)
    points = ca.horzcat(*(lens[0].undistorted(p, lens[1].steps) for p in ca.horzsplit(image)))
    return ca.Function("look", [image], [law.look(law.mount.in_body(camera.spherical(points)))])


def each_frame(function: ca.Function, images: Array) -> Array:
    """Return what a function makes of each image, (frames, k).

    Parameters
    ----------
    function : Function
        Of (2, n).
    images : (frames, n, 2)
        px.
    """
    flat = images.transpose(2, 0, 1).reshape(2, -1)
    return np.asarray(function.map(len(images))(flat).full()).T


def flown_on_pixels(
    mission: Mission,
    timing: Timing,
    pixels: Pixels,
    *,
    seed: int = 0,
    firmware: bool = False,
    keep: Callable[[Image], None] | None = None,
) -> Record:
    """Fly a mission from its start on what is found in rendered images.

    Parameters
    ----------
    mission : Mission
        With a lens; its noise and resolution of pixels do not count.
    timing : Timing
    pixels : Pixels
    seed : int
        Of all other noise, a bare number.
    firmware : bool
        Whether the exported C flies it.
    keep : callable, optional
        Given each image of the flight.
    """
    check_seed(seed)
    eyes: list[Eyes] = []

    def opened() -> Eyes:
        eyes.append(Eyes(plan, pixels, None if eyes else keep))
        return eyes[-1]

    steps = timing.steps(mission, SAMPLES, sample_bytes(mission), None)
    plan = Plan(mission, steps.step, steps.samples, steps.every, seed, scattered=False)
    if firmware:
        record = flown_firmware(mission, timing, seed=seed, eyes=opened)
    else:
        finer = SAMPLES if timing.every is None else None
        record = fly_as_built(plan, None, finer, None, opened)
    record.attrs["machine"] += ", on images"
    eyes[0].add_to(record)
    record.attrs["seen_by"] = pixels.board.words
    return record


def seen_well(record: Record) -> dict[str, Any]:
    """Return how well the target was found over a flight: px, and 1 of the feature.

    Parameters
    ----------
    record : Record
        Of `flown_on_pixels`.
    """
    true, found = record["pixel_true"].values, record["pixel_found"].values
    whole = ~np.isnan(found).any(axis=(1, 2))
    facts: dict[str, Any] = {
        "tags": record.attrs["seen_by"],
        "frames": len(whole),
        "frames_missed": int((~whole).sum()),
    }
    if not whole.any():
        return facts
    error = found[whole] - true[whole]
    middle = np.linalg.norm(error.mean(axis=1), axis=1)
    feature = record["feature_error"].values[whole]
    return facts | {
        "corner_bias": error.mean(axis=(0, 1)).tolist(),
        "corner_deviation": float(error.std(axis=0).mean()),
        "corner_largest": float(np.linalg.norm(error, axis=2).max()),
        "centroid_largest": float(middle.max()),
        "feature_bias": float(np.linalg.norm(feature.mean(axis=0))),
        "feature_deviation": float(np.sqrt(feature.var(axis=0).sum())),
        "feature_largest": float(np.linalg.norm(feature, axis=1).max()),
    }
