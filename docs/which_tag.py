"""Make the figure and the table of the guide "which tag, which height, which lens".

    python docs/which_tag.py

The gains of each row are tuned and proved here; it takes some minutes.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

import hoverproof as hp
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.files import write_text
from hoverproof.show.style import COLOURS, save_figure

HERE = Path(__file__).parent
VEHICLE = HERE.parent / "examples" / "vehicles" / "hummingbird.toml"
RATIOS = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2)
HEIGHTS = (0.6, 1.2, 2.4, 4.8)  # m
HEIGHT, RATIO = 1.2, 0.2
TIMES = (2, 3, 5, 10, 20)  # s
MARKS = {"scaled": "o", "centroid": "s"}
FEATURES = tuple(MARKS)


@dataclass(frozen=True)
class Row:
    """What is found with a tag of `ratio` times the height, in m; times in s, angle in degrees."""

    feature: str
    ratio: float
    height: float
    proved: float | None
    flown: float | None
    angle: float | None
    reason: str

    def cells(self) -> str:
        """Return the row of the table."""
        told = [f"{self.ratio * self.height:g}", f"{self.height:g}", self.feature]
        told += map(_number, (self.proved, self.flown, self.angle))
        return f"| {' | '.join(told)} |"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def tuned(feature: str, ratio: float, height: float) -> Row:
    """Tune the vehicle for a tag of that many heights, from 0.3 heights beside and above."""
    half = round(ratio * height / 2, 6)
    corners = [[half, half, 0], [half, -half, 0], [-half, -half, 0], [-half, half, 0]]
    start = [round(0.3 * height, 6), 0, round(-1.3 * height, 6)]
    asked = {
        "target.points": corners,
        "goal.height": height,
        "law.feature": feature,
        "start.position": start,
    }
    found = hp.tune(hp.replace(hp.load(VEHICLE), asked))
    verdict = getattr(found, "verdict", None)
    if not isinstance(verdict, Exponential):
        return Row(feature, ratio, height, None, None, None, getattr(found, "reason", ""))
    seen = verdict.field_of_view
    angle = None if seen is None else math.degrees(float(seen))
    time = float(verdict.settling.time)
    return Row(feature, ratio, height, time, getattr(found, "flown", None), angle, "")


def draw(rows: list[Row]) -> Figure:
    """Draw proved settling time over tag size, and over height."""
    figure = Figure(figsize=(8.4, 3.8), layout="constrained")
    by_size, by_height = figure.subplots(1, 2, sharey=True)
    for feature, colour in zip(FEATURES, COLOURS, strict=False):
        own = [r for r in rows if r.feature == feature and r.height == HEIGHT and r.proved]
        mark = MARKS[feature]
        by_size.loglog([r.ratio for r in own], [r.proved for r in own], f"{mark}-", color=colour)
        by_size.lines[-1].set_label(f"{feature}, proved")
        by_size.loglog([r.ratio for r in own], [r.flown for r in own], f"{mark}:", color=colour)
        by_size.lines[-1].set_label(f"{feature}, flown")
    high = [r for r in rows if r.feature == FEATURES[0] and r.ratio == RATIO and r.proved]
    high.sort(key=lambda r: r.height)
    by_height.loglog([r.height for r in high], [r.proved for r in high], "o-", color=COLOURS[0])
    by_height.loglog([r.height for r in high], [r.flown for r in high], "o:", color=COLOURS[0])
    by_size.set_xlabel(f"edge of the tag / height, at {HEIGHT:g} m")
    by_height.set_xlabel(f"height (m), tag of {RATIO:g} heights")
    by_size.set_ylabel("settling time (s)")
    by_size.set_xticks(RATIOS, [f"{r:g}" for r in RATIOS])
    by_height.set_xticks(HEIGHTS, [f"{h:g}" for h in HEIGHTS])
    by_size.set_yticks(TIMES, [f"{t:g}" for t in TIMES])
    for axes in (by_size, by_height):
        axes.minorticks_off()
        axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=4, fontsize="small")
    return figure


def main() -> int:
    """Tune, print, write."""
    cases = [(f, r, HEIGHT) for f in FEATURES for r in RATIOS]
    cases += [(FEATURES[0], RATIO, h) for h in HEIGHTS if h != HEIGHT]
    rows = []
    for case in cases:
        rows.append(tuned(*case))
        print(rows[-1].cells(), rows[-1].reason, flush=True)
    head = "| tag, m | height, m | feature | proved, s | flown, s | seen within, ° |\n"
    table = head + "| --- | --- | --- | --- | --- | --- |\n"
    write_text(HERE / "which-tag-table.txt", table + "".join(f"{r.cells()}\n" for r in rows))
    save_figure(draw(rows), HERE / "which-tag.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
