"""What `see` answers, and what `simulate --pixels` says of its images."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hoverproof.cli.answers.answer import Answer
from hoverproof.cli.answers.words import position_text, wrapped

MOST_TAGS = 8
"""So many other tags are named, those that were seen most."""

if TYPE_CHECKING:
    from hoverproof.eyes.at_rest import Rest


@dataclass(frozen=True)
class SeeAnswer(Answer):
    """The facts of what was seen (`Sightings.facts`), the noise at rest, and what was written."""

    facts: Mapping[str, Any]
    rest: Rest | None
    path: Path
    overlay: Path | None

    @property
    def status(self) -> int:
        """The exit status: 1 where there was nothing to be seen, or not all could be read."""
        return int(bool(self.facts["partial"]) or not self.facts["frames_whole"])

    def text(self) -> Iterator[str]:
        """Yield the lines for people."""
        facts = self.facts
        frames, whole = facts["frames"], facts["frames_whole"]
        if facts["partial"]:
            yield f"{facts['source']}: partial: {facts['partial']}"
        else:
            yield f"{facts['source']}: {frames} image{'s' * (frames != 1)}"
        yield f"  looked for              {facts['tags']}"
        if facts["law"]:
            yield f"  law                     {facts['law']}"
        part = facts["frames_in_part"]
        yield f"  all of it found         in {whole} of {frames}" + (
            f", some in {part}" if part else ""
        )
        if others := facts["others"]:
            most = sorted(others, key=lambda tag: -others[tag])[:MOST_TAGS]
            words = ", ".join(f"{tag} in {others[tag]}" for tag in most)
            more = len(others) - len(most)
            yield from wrapped("other tags seen", words + (f", and {more} more" if more else ""))
        if whole:
            yield from self._seen()
            yield from self._noise()
        yield f"  written to              {self.path}"
        if self.overlay is not None:
            yield f"  with what was found     {self.overlay}"

    def _seen(self) -> Iterator[str]:
        facts = self.facts
        if facts["longest_gap"]:
            yield f"  longest gap             {facts['longest_gap']} images"
        angle, half = facts["angle_largest"], facts["half_angle"]
        yield f"  farthest from the axis  {angle:.4g} rad"
        if half is not None:
            inside = "within" if angle <= half else "NOT within"
            yield f"                          {inside} camera.half_angle, {half:g} rad"
        names = {
            "centroid": "centroid",
            "scaled_centroid": "scaled centroid",
            "feature": "feature of the law",
            "error": "image error",
        }
        last = facts["last"]
        for key, name in names.items():
            if key in last:
                yield f"  {name:22}  ({', '.join(f'{c:.5g}' for c in last[key])})"
        place = position_text(last["camera_position"])
        yield f"  camera                  {place}, as the tags tell"
        if facts["frames"] > 1:
            yield "                          (from the last image that shows the whole target)"
        if facts["error_largest"] is not None:
            yield f"  largest image error     {facts['error_largest']:.4g}"

    def _noise(self) -> Iterator[str]:
        rest = self.rest
        if rest is None:
            if self.facts["frames"] > 1:
                yield "  noise                   not told: nowhere is it still for long enough"
            return
        yield f"  still                   {rest.begin:g} to {rest.end:g} s, {rest.frames} images"
        yield f"  noise of a corner       {rest.pixel_noise:.3g} px"
        yield f"  off any pose            {rest.pixel_bias:.3g} px, the mean corners"
        deviation = ", ".join(f"{c:.3g}" for c in rest.deviation)
        yield f"  noise of the feature    ({deviation}), {rest.feature}"
        yield f"                          bias {rest.bias:.3g}, largest {rest.largest:.3g}"
        if self.facts["single_tag"]:
            yield "  (what is off alike in every image shows little with a single tag)"
        yield "For the mission (as seen here; leave room for what was not):"
        yield from (f"  {line}" for line in rest.lines())

    def as_json(self) -> dict[str, Any]:
        """Return the object for machines."""
        rest = None
        if self.rest is not None:
            rest = asdict(self.rest) | {"deviation": self.rest.deviation.tolist()}
            rest |= {"bound": self.rest.bound, "lines": self.rest.lines()}
        overlay = None if self.overlay is None else str(self.overlay)
        return {**self.facts, "noise": rest, "overlay": overlay, "out": str(self.path)}


def images_text(facts: Mapping[str, Any]) -> Iterator[str]:
    """Yield how well a target was found in the images of a flight."""
    frames, missed = facts["frames"], facts["frames_missed"]
    yield f"  seen by images of       {facts['tags']}"
    yield f"  target missed           in {missed} of {frames} images"
    if missed < frames:
        u, v = facts["corner_bias"]
        yield (
            f"  corners, off by         {facts['corner_deviation']:.3g} px (1 σ), "
            f"mean ({u:.2g}, {v:.2g}), most {facts['corner_largest']:.3g} px"
        )
        yield f"  centroid, off by        {facts['centroid_largest']:.3g} px at most"
        yield (
            f"  feature, off by         {facts['feature_deviation']:.3g} (1 σ), "
            f"mean {facts['feature_bias']:.2g}, most {facts['feature_largest']:.3g}"
        )
