"""The tables of a report: what is known, by name, with units."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from hoverproof.algebra.decimals import angle_at_most
from hoverproof.certification.attraction.verdict import Attraction
from hoverproof.certification.bounds import eigenvalue_bounds
from hoverproof.certification.exponential.verdict import Exponential
from hoverproof.certification.flow import flow_of
from hoverproof.certification.gains import GainsVerdict
from hoverproof.certification.over_box import BoundsVerdict
from hoverproof.mission.sections import Mission
from hoverproof.plant.goal import hover_goal
from hoverproof.plausibility import warnings
from hoverproof.reporting.body import body_rows
from hoverproof.reporting.numerals import at_least, at_most, bounded, interval, place, short
from hoverproof.reporting.parts import Firmware, Flown, Missing
from hoverproof.servo.hover_error import hover_error, rests_as_modelled
from hoverproof.servo.laws.hamel_mahony import law_of
from hoverproof.servo.variables import Design

MOST = 24
"""So many target points are written out."""


class Table(NamedTuple):
    """A table of names and values.

    Attributes
    ----------
    title : str
    rows : list of (name, value)
    """

    title: str
    rows: list[tuple[str, str]]


def mission_tables(mission: Mission, q_star: Sequence[Fraction]) -> list[Table]:
    """Return what the user wrote, with units.

    Parameters
    ----------
    mission : Mission
    q_star : (3,) Fractions
        The wanted centroid, dimensionless.
    """
    tables = [
        _vehicle_table(mission),
        _law_table(mission),
        _target_table(mission, q_star),
        _bounds_table(mission),
    ]
    conditions = mission.conditions()
    if conditions:
        rows = [
            (s, "; ".join(f"{k} = {_plain(x)}" for k, x in c.items()))
            for s, c in conditions.items()
        ]
        tables.append(Table("Added to the model in flight (nothing is proved of it)", rows))
    asked = mission.asks_to_cover()
    if asked:
        rows = [("[uncertainty], [camera]", "; ".join(asked))]
        tables.append(
            Table("Asked to be covered (looked at under region of attraction alone)", rows)
        )
    return tables


def _vehicle_table(mission: Mission) -> Table:
    v = mission.vehicle
    rows = [
        ("mass", f"{short(v.mass)} kg"),
        *body_rows(v),
        ("drag torque over thrust", f"{short(v.drag_ratio)} m"),
        ("gravity", f"{short(v.gravity)} m/s²"),
        ("weight", f"{short(v.weight)} N"),
    ]
    return Table("Vehicle", rows)


def _law_table(mission: Mission) -> Table:
    law = "centroid/image/modelled, the paper's" if mission.law.is_papers else mission.law.name
    units = Design.gains().items()
    gains = [(name, f"{short(getattr(mission.gains, name))} {unit}") for name, unit in units]
    return Table("Law and gains", [("law", law), *gains, *_heading(mission)])


def _target_table(mission: Mission, q_star: Sequence[Fraction]) -> Table:
    target, height = mission.target, mission.goal.height
    goal = "by its centroid" if height is None else f"{short(height)} m above the target"
    points = "; ".join(place(p) for p in target.points[:MOST])
    if len(target.points) > MOST:
        points += f"; and {len(target.points) - MOST} more"
    weights = [("weights", ", ".join(map(short, target.weights)))] if target.weights else []
    rows = [
        (f"{len(target.points)} target points", points),
        *weights,
        ("goal", goal),
        ("hover there", place(hover_goal(mission).position)),
        ("wanted centroid q*", _vector(q_star)),
        *_wanted(mission),
        ("start", place(mission.start.position)),
        *_moving(mission),
    ]
    return Table("Target, goal and start (world frame, z down)", rows)


def _wanted(mission: Mission) -> list[tuple[str, str]]:
    """Return what stands in place of q* in the law, where that is something else."""
    if mission.law.feature == "centroid":
        return []
    return [("scaled, s*, which the law uses", _vector(law_of(mission).goal_feature(mission)))]


def _vector(entries: Sequence[Fraction]) -> str:
    return f"({', '.join(short(c, 6) for c in entries)})"


def _bounds_table(mission: Mission) -> Table:
    bounds, named = mission.bounds, flow_of(mission).named.removeprefix("the ")
    origin = "proved over a box" if bounds.eigenvalues == "auto" else "assumed"
    assumed = (
        ("thrust, assumed", f"{interval(bounds.thrust)} N")
        if bounds.thrust is not None
        else ("level of L, assumed", short(bounds.level or 0))
    )
    eigenvalues = bounded(mission, eigenvalue_bounds(mission))
    return Table("In flight", [(f"{named}, {origin}", eigenvalues), assumed])


def hover_error_tables(mission: Mission) -> list[Table]:
    """Return what an error of thrust or mass does to the hover, where that is known of the law.

    Parameters
    ----------
    mission : Mission
    """
    title = "What an error of thrust or mass does to the height above the target at rest"
    rows = hover_error(mission).rows() if rests_as_modelled(law_of(mission)) else []
    if mission.law.force == "measured":
        rows = [("nothing", "the law measures the sum of all forces, which is zero at rest")]
    elif not rows:
        rows = [("not computed for this law", "fly it: [model_error] mass and thrust of a mission")]
    return [Table(title, rows)]


def strange_tables(mission: Mission) -> list[Table]:
    """Return what is strange about a mission, if anything is.

    Parameters
    ----------
    mission : Mission
    """
    rows = [(finding.key, finding.reason) for finding in warnings(mission)]
    return [Table("Not as in any vehicle: check the units", rows)] if rows else []


def _heading(mission: Mission) -> list[tuple[str, str]]:
    if mission.goal.heading is None:
        return []
    gain = ("k_heading", f"{short(mission.k_heading)} kg m²/s²")
    source = "the image" if mission.goal.heading_from == "image" else "a compass"
    return [gain, (f"heading, by {source}", f"{short(mission.goal.heading)} rad")]


def _moving(mission: Mission) -> list[tuple[str, str]]:
    start = mission.start
    rows = (
        ("velocity", start.velocity, "m/s"),
        ("roll, pitch, yaw", start.rotation, "rad"),
        ("rates", start.rates, "rad/s"),
    )
    moving = [(n, f"({', '.join(map(short, x))}) {unit}") for n, x, unit in rows if any(x)]
    return moving or [("at the start", "level, at rest")]


def _plain(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_plain, value))}]"
    try:
        return short(Fraction(value))
    except ValueError:
        return str(value)


def margins_table(verdict: GainsVerdict) -> Table:
    """Return the bounds of the worst eigenvalue of Σ, and the decay rate.

    Parameters
    ----------
    verdict
        What `hoverproof.certify` returned.
    """
    rows = []
    if verdict.status == "proved":
        gap = float(verdict.margin_above / verdict.margin - 1)
        rows = [
            ("proved lower bound", f"{at_least(verdict.margin, 8)} kg/s"),
            ("proved upper bound", f"{at_most(verdict.margin_above, 8)} kg/s"),
            ("the two are apart by", f"{short(gap, 1)} of the margin"),
            ("decay rate of L, proved", f"{at_least(verdict.decay_rate, 6)} 1/s"),
            ("so L halves in at most", f"{at_most(Fraction(np.log(2)) / verdict.decay_rate)} s"),
        ]
    elif verdict.margin_above is not None:
        below = "some eigenvalue is negative" if verdict.margin_above < 0 else "of an unknown sign"
        rows = [
            ("proved lower bound", "none"),
            ("proved upper bound", f"{at_most(verdict.margin_above, 8)} kg/s, so {below}"),
            ("decay rate of L", "none is proved"),
        ]
    else:
        rows = [("bounds", "none were found")]
    symbol = verdict.problem.flow.symbol
    return Table(f"Worst eigenvalue of Σ over all {symbol} and T that are allowed", rows)


def region_table(found: BoundsVerdict) -> Table:
    """Return the bounds of Q, or of J, over a box.

    Parameters
    ----------
    found : ProvedBounds, RefutedBounds or UndecidedBounds
    """
    named = flow_of(found.mission).named
    rows = [
        (f"box, {axis}", f"{interval(side)} m") for axis, side in zip("xyz", found.box, strict=True)
    ]
    if found.enclosure is not None:
        proved = bounded(found.mission, found.enclosure.eigenvalues, "outward")
        rows.append((f"{named.removeprefix('the ')} there, proved", proved))
        rows.append(("found there", bounded(found.mission, found.enclosure.attained)))
    return Table(f"The box and {named} in it", rows)


def attraction_table(region: Attraction) -> Table:
    """Return how far the region reaches, and what holds in it.

    Parameters
    ----------
    region : Attraction
    """
    reach, height = region.reach, region.barrier_height
    rows = [
        ("sideways, all round", f"{at_least(reach.sideways)} m"),
        ("up", f"{at_least(reach.up)} m"),
        ("down", f"{at_least(reach.down)} m"),
        ("tilt on the way", f"{angle_at_most(region.tilt)} or less"),
        (
            "thrust on the way",
            f"{at_least(region.thrust[0], 5)} to {at_most(region.thrust[1], 5)} N",
        ),
        ("eigenvalues of Q", f"{at_most(region.largest_eigenvalue)} 1/m or less"),
    ]
    if height is not None:
        rows.append(("height above the target", f"{at_least(height)} m or more"))
    return Table("Certified hovers about the goal, and what holds on the way", rows)


def exponential_table(verdict: Exponential) -> Table:
    """Return from where and how soon every vehicle is at its goal, and what holds on the way.

    Parameters
    ----------
    verdict : Exponential
    """
    low, high = verdict.heights
    settling = verdict.settling
    rows = [
        ("vehicles", ", ".join(verdict.mission.covers()) or "as modelled"),
        *(("start", place([(a + b) / 2 for a, b in s.position])) for s in verdict.starts),
        ("settled", f"within {at_most(settling.radius)} m from {at_most(settling.time)} s on"),
        ("decay rate of Ψ", f"{at_least(verdict.rate)} 1/s or more"),
        ("height above the target", f"{at_least(low)} to {at_most(high)} m"),
        ("tilt on the way", f"{angle_at_most(verdict.tilt)} or less"),
        (
            "thrust on the way, × true / modelled mass",
            f"{at_least(verdict.thrust[0], 5)} to {at_most(verdict.thrust[1], 5)} N",
        ),
    ]
    if verdict.field_of_view is not None:
        rows.append(("target points", f"within {angle_at_most(verdict.field_of_view)} of the axis"))
    least, most = verdict.rotor_thrust
    rows.append(("thrust of each rotor", f"{at_least(least)} to {at_most(most)} N"))
    return Table("Every vehicle within tolerance, and what holds on the way", rows)


def flight_table(flown: Flown) -> Table:
    """Return what a flight came to.

    Parameters
    ----------
    flown : Flown
    """
    told = flown.summary
    settled = told["settled_at"]
    rows = [
        ("outcome", str(told["outcome"])),
        ("length", f"{short(told['duration'])} s"),
        ("start", f"{place(told['start_position'])}, {short(told['start_error'])} m from the goal"),
        (
            "end",
            f"{place(told['final_position'])}, {short(told['final_error'], 2)} m from the goal",
        ),
        (
            "within 10 % of the distance at the start",
            "not reached" if settled is None else f"from {short(settled)} s on",
        ),
        ("largest tilt", f"{short(np.degrees(told['largest_tilt']), 3)}°"),
        ("rotor thrusts", f"{interval(told['rotor_thrust'])} N"),
    ]
    if "ideal_settled_at" in told:
        far = short(told["greatest_distance_from_ideal"], 3)
        rows.append(("from the flight of the ideal model", f"at most {far} m away"))
    if told["frames_lost"]:
        rows.append(("frames with a target point out of view", str(told["frames_lost"])))
    return Table("The flight", rows)


def runs_table(told: dict[str, Any]) -> Table:
    """Return what many flights came to.

    Parameters
    ----------
    told : dict
        Summary of the runs: distances in m, times in s.
    """
    rows = [(name.replace("_", " "), str(n)) for name, n in told["outcomes"].items() if n]
    rows.append(("settled within 10 %", str(told["settled"])))
    for name, unit in (("settled_at", "s"), ("final_error", "m")):
        quantiles = told[name]
        if quantiles is not None and np.isfinite(quantiles).all():
            low, middle, high = (short(x, 3) for x in quantiles)
            words = {"settled_at": "settled at", "final_error": "error at the end"}[name]
            rows.append((words, f"median {middle} {unit}, 90 % within {low} to {high} {unit}"))
    return Table("Outcomes", rows)


def firmware_table(firmware: Firmware) -> Table:
    """Return what the firmware costs.

    Parameters
    ----------
    firmware : Firmware
    """
    budgets, held = firmware.manifest["budgets"], firmware.footprint
    here = None if isinstance(held, Missing) else held
    rows = [
        ("target", str(budgets["target"])),
        ("instructions of a step", f"at most {budgets['instructions']} (budget, held by a test)"),
        ("stack of a step", _used(here.stack if here else None, budgets["stack_bytes"])),
        ("flash", _used(here.flash if here else None, budgets["flash_bytes"])),
        (
            "thrust that is monitored",
            f"{interval(firmware.manifest['thrust'])} N; other with the certificate of a start",
        ),
        ("limits of each rotor", f"{interval(firmware.manifest['rotor_limits'])} N"),
    ]
    return Table("The firmware", rows)


def _used(measured: int | None, budget: int) -> str:
    if measured is None:
        return f"at most {budget} bytes (budget; not measured here)"
    if measured > budget:
        return f"{measured} bytes, over the budget of {budget}, which is for four rotors"
    return f"{measured} bytes, of a budget of {budget}"
