"""How pictures look: colours, legends beside the data, files written whole."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import (
    LogFormatterSciNotation,
    LogLocator,
    NullFormatter,
    StrMethodFormatter,
)

from hoverproof.files import replacing
from hoverproof.mission.sections import Mission

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's palette, told apart by the colour-blind."""

MOST_ROUND, FEW_DIGITS = 2000, 30
"""Up to which ratio of its ends an axis has round numbers, and up to which 1, 2 and 5 of them."""

HATCHED: Any = {"facecolor": "#D0D0D0", "edgecolor": "white", "hatch": "///", "linewidth": 0}
"""Of a part of a map without colour, to be told from its colours in a grey print."""

STYLES = ("-", "--", "-.", ":")

DPI = 130
SVG_DPI = 72
"""An SVG is in points, whatever is asked for."""


RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Powers(LogFormatterSciNotation):
    """Write 10⁻³ in letters; set as a formula it takes far longer."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return what stands at x."""
        set_by_tex = super().__call__(x, pos).replace(r"\times", "×")
        raised = re.sub(r"\^\{(.*?)\}", lambda power: power[1].translate(RAISED), set_by_tex)
        return re.sub(r"\$|\\mathdefault|[{}]", "", raised)


def heading(mission: Mission, words: str, width: int) -> str:
    """Return the title of what is proved: name, and the words with which vehicles for ``{who}``.

    Parameters
    ----------
    mission : Mission
    words : str
    width : int
        Number of letters in a line.
    """
    covers = ", ".join(each.replace(" ", "\xa0") for each in mission.covers())
    who = f"every vehicle with {covers}" if covers else "the vehicle as modelled"
    return "\n".join(textwrap.wrap(f"{mission.name}: {words.format(who=who)}", width))


def plain_powers(axis: Axis) -> None:
    """Write the numbers at a logarithmic axis in letters; see `Powers`.

    Parameters
    ----------
    axis : Axis
    """
    axis.set_major_formatter(Powers())
    axis.set_minor_formatter(Powers())


def round_numbers(axis: Axis) -> None:
    """Write 0.02 and 50 along a logarithmic axis of few decades, powers of ten along a longer one.

    Parameters
    ----------
    axis : Axis
        Whose limits are set.
    """
    low, high = axis.get_view_interval()
    if high > MOST_ROUND * low:
        plain_powers(axis)
        return
    digits = (1, 2, 5) if high < FEW_DIGITS * low else (1, 3)
    axis.set_major_locator(LogLocator(subs=digits))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def hatched(axes: Axes, label: str) -> Patch:
    """Hatch what nothing else covers of `axes`; return it for the legend.

    Parameters
    ----------
    axes : Axes
    label : str
        What is there.
    """
    axes.add_patch(Rectangle((0, 0), 1, 1, transform=axes.transAxes, zorder=0, **HATCHED))
    return Patch(**HATCHED, label=label)


def legend_above(axes: Axes, columns: int = 5) -> None:
    """Put the legend of `axes` above them, where it covers no data, and draw a grid.

    Parameters
    ----------
    axes : Axes
        What to draw on.
    columns : int
        Number of entries side by side.
    """
    axes.grid(alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0, 1),
            ncols=columns,
            frameon=False,
            borderaxespad=0.2,
            handlelength=2.2,
            columnspacing=1.0,
            fontsize=9,
        )


def save_figure(figure: Figure, path: Path, dpi: int = DPI) -> None:
    """Write a figure as SVG if the file's name ends so, and as PNG if not.

    Parameters
    ----------
    figure : Figure
    path : Path
        The file.
    dpi : int
        Number of pixels in an inch of the figure.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    with replacing(path) as beside:
        ending = "svg" if path.suffix.lower() == ".svg" else "png"
        figure = laid_out(figure, ending, dpi)
        figure.savefig(beside, dpi=dpi, format=ending)


def laid_out(figure: Figure, ending: str, dpi: int = DPI) -> Figure:
    """Put everything in its place, once: `savefig` would draw the whole figure to do so.

    Parameters
    ----------
    figure : Figure
    ending : {"png", "svg"}
        How it will be saved: letters are measured as they are drawn.
    dpi : int
        Number of pixels in an inch of a PNG.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        if ending == "svg":
            from matplotlib.backends.backend_svg import FigureCanvasSVG

            FigureCanvasSVG(figure)
        figure.set_dpi(SVG_DPI if ending == "svg" else dpi)
        engine.execute(figure)
        figure.set_layout_engine(None)
    return figure
