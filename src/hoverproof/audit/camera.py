"""Whether images are as large as they are from where the vehicle was: wrong intrinsics are not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoverproof.audit.claim import Poses
from hoverproof.audit.finding import Finding, over_time, untold
from hoverproof.audit.fitting import over
from hoverproof.servo.loop import LoopNumbers, level_feature

Array = NDArray[np.float64]

WINDOW = 0.2
TOLD = 0.05
"""Images that are larger or smaller by less are not told from errors of the position, a share."""


def scale(poses: Poses) -> Finding:
    """Judge the focal length by the height that the scaled feature tells, and the estimated one.

    The scaled feature is the distance of the target in its own size: an image that is s times as
    large makes it 1/s times as long. The plain centroid does not tell that of a small target.

    Parameters
    ----------
    poses : Poses
    """
    name, log, mission = "scale of the image", poses.log, poses.mission
    if mission.law.feature != "scaled" or mission.camera.has_arm:
        return untold(name, "told by the scaled feature of a camera at the centre of mass alone")
    if not log.has("position", "rotation", "feature", "image_age"):
        return untold(name, "needs estimated positions from the target, features and their age")
    assert log.position is not None and log.rotation is not None
    assert log.feature is not None and log.image_age is not None
    numbers = LoopNumbers.of(mission)
    known = np.isfinite(log.feature).all(axis=1) & np.isfinite(log.image_age)
    then = (log.times - log.image_age)[known]
    places = np.stack([np.interp(then, log.times, c) for c in log.position.T], axis=1)
    told = level_feature(numbers.target_size, numbers.law).map(len(places))
    predicted = np.asarray(told(np.tile(numbers.points, len(places)), places.T).full()).T
    lengths = [np.linalg.norm(v, axis=1) for v in (predicted, log.feature[known])]
    large = over(log.times[known], lengths[0] / lengths[1], WINDOW)
    middle, spread = float(np.nanmedian(large)), float(np.nanstd(large))
    words = f"images are {middle:.4g} ± {spread:.1g} times as large as by the estimated positions"
    return over_time(
        name,
        "",
        log.times[known],
        abs(large - 1),
        TOLD,
        "1",
        deviation=spread,
        words=words,
    )
