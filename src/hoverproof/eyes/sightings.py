"""What images tell: the features of a target over time, and the noise of them at rest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hoverproof.errors import InputError
from hoverproof.eyes.detector import Detector, Image
from hoverproof.eyes.opencv import opencv
from hoverproof.eyes.video import Source
from hoverproof.mission.sections import Mission
from hoverproof.mission.tags import Board
from hoverproof.plant import camera
from hoverproof.plant.lens import LensModel, Sight
from hoverproof.plant.mount import CENTRAL, Mount
from hoverproof.servo.laws.choices import CENTROID, SCALED
from hoverproof.servo.loop import LoopNumbers
from hoverproof.servo.variables import Measurement
from hoverproof.simulation.record import Column, Record
from hoverproof.version import __version__

Array = NDArray[np.float64]

AMBIGUOUS = 2.0, 0.05
"""A pose whose corners miss by so many times as much, and px more, may be meant as well."""


@dataclass(frozen=True, eq=False)
class Viewer:
    """What looks at images: a board, a lens and, with a mission, its law.

    Attributes
    ----------
    board : Board
    lens : LensModel
    sight : Sight
        How far its image reaches.
    mission : Mission, optional
    """

    board: Board
    lens: LensModel
    sight: Sight
    mission: Mission | None = None

    @cached_property
    def detector(self) -> Detector:
        """What finds the tags."""
        return Detector(self.board, self.lens, self.sight)

    @cached_property
    def mount(self) -> Mount:
        """How the camera sits; by default its axes are those that all is told in."""
        return CENTRAL if self.mission is None else Mount.of(self.mission)

    @cached_property
    def numbers(self) -> LoopNumbers | None:
        """Those of the mission."""
        return None if self.mission is None else LoopNumbers.of(self.mission)

    @cached_property
    def told(self) -> ca.Function:
        """(2, n) px, ρ (3, 1) ↦ centroid, scaled centroid, feature and error of the law, angle.

        Vectors are in body axes; the angle, rad, is that from the optical axis to the point that is
        farthest from it. Without a mission the last two vectors are empty.
        """
        n = len(self.board.order)
        image, down = ca.SX.sym("image", 2, n), ca.SX.sym("down", 3)
        undistorted = [self.lens.undistorted(p, self.sight.steps) for p in ca.horzsplit(image)]
        rays = camera.spherical(ca.horzcat(*undistorted))
        directions = self.mount.in_body(rays)
        angle = ca.mmax(ca.atan2(ca.sqrt(rays[0, :] ** 2 + rays[1, :] ** 2), rays[2, :]))
        own = [ca.SX(0, 1), ca.SX(0, 1)]
        if self.numbers is not None:
            law, none = self.numbers.law, ca.SX.zeros(3)
            own[0] = law.look(directions)
            measured = Measurement(own[0], none, down, none, ca.SX(0))
            design = law.design.from_vector(ca.SX(ca.DM(self.numbers.design)))
            own[1] = law.goal.error(measured, design)
        several = [CENTROID.seen(directions), SCALED.seen(directions), *own, angle]
        return ca.Function("told", [image, down], [ca.densify(part) for part in several])

    def found(self, image: Image, where: str) -> tuple[Array, list[int]]:
        """Return where the target points are in an image, (n, 2), px, and which other tags.

        Of what is not found it is not a number.

        Parameters
        ----------
        image : (height, width) uint8
            Grey levels.
        where : str
            Of it, for messages.

        Raises
        ------
        InputError
            If it has another size than the lens was calibrated for.
        """
        height, width = image.shape
        if (width, height) != (round(self.lens.width), round(self.lens.height)):
            wanted = f"{self.lens.width:g} x {self.lens.height:g} px"
            reason = f"has images of {width} x {height} px, the calibration is for {wanted}"
            raise InputError(where, "", f"{reason}: give that of this size")
        corners, others = self.detector.found(image)
        return corners.reshape(-1, 2)[self.board.order], others

    def pose(self, pixels: Array) -> tuple[Array, Array]:
        """Return where the camera is, (3,), m, and its axes, (3, 3), world frame, as they fit best.

        Where two poses of a flat board fit nearly alike, it is the one that looks down steeper.

        Parameters
        ----------
        pixels : (n, 2)
            px, all of the target.
        """
        cv2 = opencv()
        pixel = ca.SX.sym("pixel", 2)
        straight = ca.Function("ray", [pixel], [self.lens.undistorted(pixel, self.sight.steps)])
        rays = np.ascontiguousarray(np.asarray(straight.map(len(pixels))(pixels.T).full()).T)
        points = np.ascontiguousarray(self.board.points)
        flat = np.ptp(points[:, 2]) < 1e-9
        kind = cv2.SOLVEPNP_IPPE if flat else cv2.SOLVEPNP_SQPNP
        _, turns, places, missed = cv2.solvePnPGeneric(points, rays, np.eye(3), None, flags=kind)
        misses = np.ravel(missed) * self.lens.fx
        times, more = AMBIGUOUS
        likely = [i for i, miss in enumerate(misses) if miss <= times * misses.min() + more]
        axes = {i: cv2.Rodrigues(turns[i])[0].T for i in likely}
        i = max(likely, key=lambda i: axes[i][2, 2])
        turn, place = cv2.solvePnPRefineLM(points, rays, np.eye(3), None, turns[i], places[i])
        rotation = np.asarray(cv2.Rodrigues(turn)[0].T)
        return -rotation @ np.ravel(place), rotation

    def fitted(self, position: Array, rotation: Array) -> Array:
        """Return where the target points would be in the image from a pose, (n, 2), px.

        Parameters
        ----------
        position : (3,)
            World frame, m.
        rotation : (3, 3)
            Camera to world, dimensionless.
        """
        seen = (self.board.points - position) @ rotation
        point = ca.SX.sym("point", 2)
        bent = ca.Function("pixel", [point], [self.lens.pixel(point)])
        return np.asarray(bent.map(len(seen))((seen[:, :2] / seen[:, 2:]).T).full()).T


@dataclass
class Sightings:
    """What was seen, frame by frame.

    Attributes
    ----------
    viewer : Viewer
    source : Source
    times : list of float
        s.
    pixels : list of (n, 2) arrays
        px; not a number of what was not found.
    others : Counter of int
        In how many images there were other tags of the family, by their numbers.
    """

    viewer: Viewer
    source: Source
    times: list[float] = field(default_factory=list)
    pixels: list[Array] = field(default_factory=list)
    others: Counter[int] = field(default_factory=Counter)

    def look(
        self, shown: Callable[[Image, Array], None], report: Callable[[int, int], None]
    ) -> None:
        """Look at all images.

        Parameters
        ----------
        shown : callable
            Given each image and where the target points are in it, px.
        report : callable
            Told how many images are done, and how many there are, 0 if it is not known.
        """
        for time, image in self.source.images:
            corners, others = self.viewer.found(image, self.source.name)
            self.pixels.append(corners)
            self.others.update(others)
            self.times.append(time)
            shown(image, self.pixels[-1])
            report(len(self.times), max(self.source.expected, len(self.times)))

    @cached_property
    def whole(self) -> NDArray[np.bool_]:
        """In which frames all of the target was found."""
        return np.array([not np.isnan(p).any() for p in self.pixels], bool)

    @cached_property
    def poses(self) -> list[tuple[Array, Array]]:
        """Where the camera was in each of those frames; see `Viewer.pose`."""
        return [
            self.viewer.pose(p) for p, whole in zip(self.pixels, self.whole, strict=True) if whole
        ]

    def told(self, pixels: Array, downs: Array) -> list[Array]:
        """Return what frames tell, (frames, k) each; see `Viewer.told`.

        Parameters
        ----------
        pixels : (frames, n, 2)
            px.
        downs : (frames, 3)
            The vertical in body axes, dimensionless.
        """
        flat = pixels.transpose(2, 0, 1).reshape(2, -1)
        mapped = self.viewer.told.map(len(pixels))(flat, downs.T)
        return [np.asarray(part.full()).T for part in mapped]

    def downs(self, poses: list[tuple[Array, Array]]) -> Array:
        """Return the vertical in body axes of poses of the camera, (frames, 3).

        Parameters
        ----------
        poses : list of (3,) and (3, 3) arrays
        """
        axes = np.array(self.viewer.mount.rotation)
        return np.array([axes @ rotation[2] for _, rotation in poses]).reshape(-1, 3)

    def record(self) -> Record:
        """Return all of it with names and units."""
        viewer, count = self.viewer, len(self.times)
        columns: dict[str, Column] = {}

        def add(name: str, dims: tuple[str, ...], values: Any, units: str, words: str) -> None:
            columns[name] = Column(dims, np.asarray(values), {"units": units, "long_name": words})

        def over_time(part: Array) -> Array:
            values = np.full((count, part.shape[1]), np.nan)
            values[self.whole] = part
            return values

        pixels = np.array(self.pixels).reshape(count, -1, 2)
        add("pixel", ("time", "point", "image_axis"), pixels, "px", "target point in the image")
        if self.whole.any():
            told = self.told(pixels[self.whole], self.downs(self.poses))
            axes = ("time", "body_axis")
            names = ("centroid", "scaled_centroid", "feature", "error")
            words = ("image centroid q", "scaled centroid", "feature of the law", "its image error")
            for name, part, long in zip(names, told, words, strict=False):
                if part.shape[1]:
                    add(name, axes, over_time(part), "1", f"{long}, body axes")
            angle = over_time(told[4])[:, 0]
            add("angle", ("time",), angle, "rad", "from the optical axis to the farthest point")
            places = over_time(np.array([position for position, _ in self.poses]))
            add("camera_position", ("time", "axis"), places, "m", "as the corners fit, world frame")
        axes3, n = ["x", "y", "z"], pixels.shape[1]
        coordinates = {"time": self.times, "body_axis": axes3, "axis": axes3}
        coordinates |= {"image_axis": ["u", "v"], "point": np.arange(1, n + 1)}
        units = {"time": {"units": "s"}}
        return Record(
            columns,
            {k: Column((k,), np.asarray(v), units.get(k, {})) for k, v in coordinates.items()},
            {
                "title": f"what was seen in {self.source.name}",
                "tags": viewer.board.words,
                "frames_expected": self.source.expected,
                "partial": self.source.short,
                "hoverproof_version": __version__,
            },
        )

    def facts(self, record: Record) -> dict[str, Any]:
        """Return what it came to.

        Parameters
        ----------
        record : Record
            Of `record`.
        """
        found = ~np.isnan(record["pixel"].values).any(axis=2)
        tags = found[:, np.argsort(self.viewer.board.order)].reshape(len(found), -1, 4).all(axis=2)
        facts: dict[str, Any] = {
            "source": self.source.name,
            "tags": self.viewer.board.words,
            "single_tag": len(self.viewer.board.numbers) == 1,
            "partial": self.source.short or None,
            "frames": len(self.times),
            "frames_expected": self.source.expected or None,
            "frames_whole": int(self.whole.sum()),
            "frames_in_part": int((tags.any(axis=1) & ~self.whole).sum()),
            "others": {
                f"{self.viewer.board.family}:{k}": n for k, n in sorted(self.others.items())
            },
            "law": None if self.viewer.numbers is None else self.viewer.numbers.law.name,
        }
        if not self.whole.any():
            return facts
        last = {}
        for name in ("centroid", "scaled_centroid", "feature", "error", "camera_position"):
            if name in record.variables:
                last[name] = record[name].values[self.whole][-1].tolist()
        gaps = np.diff(np.flatnonzero(self.whole), prepend=-1, append=len(self.whole)) - 1
        errors = record["error"].values[self.whole] if "error" in record.variables else None
        largest = None if errors is None else float(np.linalg.norm(errors, axis=1).max())
        return facts | {
            "longest_gap": int(gaps.max()),
            "angle_largest": float(np.nanmax(record["angle"].values)),
            "error_largest": largest,
            "last": last,
        }
