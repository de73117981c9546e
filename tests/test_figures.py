"""The pictures of a flight: what they say, in which units, and that the certified line holds."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import matplotlib as mpl
import matplotlib.colors
import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import hoverproof as hp
from hoverproof.certification.over_box import certify_region
from hoverproof.certification.region import default_box
from hoverproof.mission.reading import load
from hoverproof.plant.goal import hover_goal
from hoverproof.show import figures, panels, style
from hoverproof.show.decay import Decay, decay_along
from hoverproof.show.image_plane import draw_image, seen, view_angle
from hoverproof.show.region import region_figure
from hoverproof.show.scene import Scene
from hoverproof.simulation.flight import flown, simulate
from hoverproof.simulation.timing import Timing

UNITS = ("(m)", "(m), down", "(deg)", "(N)", "(s)", "(focal lengths)", "(focal lengths), down")


@pytest.fixture(scope="module")
def flight(x4):
    return simulate(x4, duration=1500)


@pytest.fixture(scope="module")
def proved(x4):
    return hp.certify(x4)


def labels(figure):
    for axes in figure.axes:
        yield axes.get_xlabel(), axes
        yield axes.get_ylabel(), axes
        if hasattr(axes, "get_zlabel"):
            yield axes.get_zlabel(), axes


def drawn(axes, label):
    return next(line for line in axes.lines if line.get_label().startswith(label))


@pytest.mark.parametrize("name", figures.FIGURES)
def test_every_axis_of_every_figure_has_its_unit(flight, name):
    figure = getattr(figures, f"{name}_figure")(flight)
    given = [label for label, _ in labels(figure) if label]
    assert len(given) >= 4
    for label in given:
        assert label.endswith((*UNITS, "(dimensionless)")), label
    for axes in figure.axes:  # a shared axis is labelled once, at the bottom of its column
        assert axes.get_ylabel() or axes.get_subplotspec().colspan.start > 0
        assert axes.get_xlabel() or not axes.get_subplotspec().is_last_row()


@pytest.mark.slow
@pytest.mark.parametrize("name", figures.FIGURES)
def test_no_legend_covers_data(flight, name):
    figure = getattr(figures, f"{name}_figure")(flight)
    figure.draw_without_rendering()
    boxes = [axes.get_window_extent() for axes in figure.axes]
    for axes in figure.axes:
        legend = axes.get_legend()
        if legend is not None and not hasattr(axes, "get_zlabel"):
            extent = legend.get_window_extent()
            assert not any(box.overlaps(extent.shrunk(0.98, 0.98)) for box in boxes)
            assert extent.x1 <= figure.bbox.x1


@pytest.mark.slow
def test_all_figures_are_written_with_sane_sizes(flight):
    paths = figures.save_figures(flight, Path("a"))
    assert [p.name for p in paths] == ["a.motion.png", "a.features.png", "a.path.png"]
    for path in paths:
        assert 30_000 < path.stat().st_size < 1_000_000
        with Image.open(path) as picture:
            assert 800 <= picture.width <= 1600
            assert picture.height >= 500
            assert len(set(picture.convert("RGB").resize((200, 150)).getdata())) > 20


def test_the_motion_is_the_recorded_one(flight):
    figure = figures.motion_figure(flight)
    place, angles, *_ = (figure.axes[i] for i in range(0, len(figure.axes), 2))
    assert np.array_equal(drawn(place, "x").get_ydata(), flight["position"][:, 0])
    roll = flight["euler_angles"].sel(angle="roll")
    assert np.allclose(drawn(angles, "roll").get_ydata(), np.degrees(roll))


def test_a_flight_that_stays_busy_has_no_column_for_its_beginning(x4):
    assert len(figures.motion_figure(simulate(x4, duration=1)).axes) == 4


def test_the_certified_line_is_above_the_simulated_L_and_falls_at_the_proved_rate(flight, proved):
    decay = decay_along(flight, proved)
    assert decay == Decay(float(proved.decay_rate), 1500.0)
    axes = figures.features_figure(flight, decay).axes[1]
    line, level = drawn(axes, "certified"), drawn(axes, "L")
    assert np.array_equal(line.get_xdata(), level.get_xdata())
    assert line.get_ydata()[0] == level.get_ydata()[0]
    assert (line.get_ydata()[1:] > level.get_ydata()[1:]).all()
    fall = np.log(line.get_ydata()[0] / line.get_ydata()[-1]) / 1500
    assert fall == pytest.approx(float(proved.decay_rate), rel=1e-12)


def test_the_legend_claims_no_more_than_is_proved(proved):
    label = Decay(float(proved.decay_rate), 1.0).label()
    stated = Fraction(label.split("exp(-")[1].split(" t")[0])
    assert 0.99 * proved.decay_rate < stated <= proved.decay_rate


def test_without_a_proof_there_is_no_certified_line(flight):
    axes = figures.features_figure(flight).axes[1]
    assert not any("certified" in line.get_label() for line in axes.lines)


@pytest.mark.parametrize(
    "change",
    [
        {"start.rates": "[0, 0, 0.1]"},  # turns about the vertical
        {"bounds.thrust": "[94.079, 94.081]"},  # the thrust leaves that at once
    ],
)
def test_no_line_is_drawn_for_a_flight_that_the_proof_does_not_cover(change, proved):
    mission = load("x4-flyer", change)
    verdict = hp.certify(mission)
    assert verdict.status == "proved"
    assert decay_along(simulate(mission, duration=20), verdict) is None


def test_the_line_ends_where_the_flight_leaves_the_bounds(flight, proved):
    lowest = proved.problem.eigenvalues[0]
    problem = replace(proved.problem, eigenvalues=(lowest, Fraction(1)))
    decay = decay_along(flight, replace(proved, problem=problem))
    assert 0 < decay.until < 1500
    axes = figures.features_figure(flight, decay).axes[1]
    line = drawn(axes, "certified")
    assert line.get_xdata()[-1] == decay.until
    assert f"until {decay.until:g} s" in line.get_label()


def test_nothing_is_certified_of_what_was_added_to_the_model(flight, proved):
    scattered = flight.assign_attrs(conditions='{"scatter": {"position": ["1", "1", "1"]}}')
    assert decay_along(scattered, proved) is not None
    windy = flight.assign_attrs(conditions='{"wind": {"mean": ["1", "0", "0"]}}')
    assert decay_along(windy, proved) is None


def test_weights_other_than_one_belong_to_another_L(flight, proved):
    problem = replace(proved.problem, weights=(Fraction(2),) * 4)
    assert decay_along(flight, replace(proved, problem=problem)) is None


def test_the_largest_angle_off_the_axis_is_marked(flight):
    axes = Figure().subplots()
    panels.required_view(axes, flight)
    mark = drawn(axes, "largest")
    rays = flight["image"].values
    cosine = 1 / np.sqrt(1 + (rays**2).sum(axis=-1))
    assert mark.get_ydata()[0] == pytest.approx(np.degrees(np.arccos(cosine)).max())
    assert f"{mark.get_ydata()[0]:.1f}°" in mark.get_label()
    (circle,) = (p for p in figures.features_figure(flight).axes[0].patches)
    assert circle.radius == pytest.approx(np.linalg.norm(rays, axis=-1).max())


def test_the_goal_image_is_what_the_flight_ends_with(flight, x4):
    ended = flight["image"].values[-1]
    assert np.abs(Scene.of(flight).goal_image(0.0) - ended).max() < 2e-3
    turned = Scene.of(flight).goal_image(np.pi / 2)
    assert np.allclose(turned, Scene.of(flight).goal_image(0.0) @ [[0, -1], [1, 0]])
    assert np.allclose(Scene.of(flight).goal, [float(c) for c in hover_goal(x4).position])


def test_limits_of_the_rotors_and_the_edge_of_the_image_are_drawn_if_there_are_any(flight):
    limits = {
        "rotors": {"min_thrust": "2", "max_thrust": "2354/100"},
        "sensors": {"focal_length": "400", "width": "1280", "height": "800"},
    }
    bounded = flight.assign_attrs(conditions=json.dumps(limits))
    axes = Figure().subplots()
    panels.rotor_forces(axes, bounded)
    assert drawn(axes, "highest 23.54 N").get_ydata()[0] == 23.54
    assert "not drawn" in drawn(axes, "lowest 2 N").get_label()
    axes = Figure().subplots()
    panels.required_view(axes, bounded)
    assert drawn(axes, "nearest edge").get_ydata()[0] == 45
    axes = Figure().subplots()
    draw_image(axes, bounded)
    (edge,) = (p for p in axes.patches if p.get_label() == "edge of the image")
    assert (edge.get_width(), edge.get_height()) == (3.2, 2.0)


def test_the_lens_of_the_mission_is_drawn_as_wide_as_it_sees():
    tilted = {"camera.half_angle": "0.6", "camera.rotation": "[0.1, 0, 0]"}
    for change, half in (({"camera.half_angle": "0.6"}, 0.6), (tilted, 0.5)):
        recorded = simulate(load("x4-flyer", change), duration=1)
        axes = Figure().subplots()
        panels.required_view(axes, recorded)
        assert drawn(axes, "lens").get_ydata()[0] == pytest.approx(np.degrees(half))
        axes = figures.features_figure(recorded).axes[0]
        assert f"to {np.degrees(half):.1f}° off the axis" in drawn(axes, "lens").get_label()
        assert axes.patches[-1].radius == pytest.approx(np.tan(half))


def test_what_no_camera_sees_of_a_crash_is_not_drawn_and_the_title_says_how_it_ended():
    crash = simulate(load("x4-flyer", {"model_error.mass": "0.005"}))
    assert np.abs(crash["image"].values).max() > 1000
    figure = figures.features_figure(crash)
    assert "with mass +0.5 %" in figure.get_suptitle()
    assert crash.attrs["outcome"] in figure.get_suptitle()
    left = figure.axes[0]
    assert all(abs(end) < 10 for end in (*left.get_xlim(), *left.get_ylim()))
    assert drawn(left, "points up to 90").get_label().endswith("(not drawn)")
    image = seen(crash)
    assert np.isnan(image[-1]).all()
    assert np.array_equal(image[0], crash["image"].values[0])


def test_a_point_behind_the_camera_is_seen_nowhere(flight):
    over = flight["rotation"].values * [[1, -1, -1]]  # a half turn about the first axis
    behind = flight.assign(rotation=(flight["rotation"].dims, over))
    assert np.isnan(seen(behind)).all()
    assert (view_angle(behind) > np.pi / 2).all()


def test_the_words_of_limits_do_not_take_the_width_of_the_panels(x4):
    limits = json.dumps({"rotors": {"min_thrust": "2", "max_thrust": "60"}})
    figure = figures.motion_figure(simulate(x4, duration=1).assign_attrs(conditions=limits))
    figure.draw_without_rendering()
    assert figure.axes[2].bbox.x1 > 0.95 * figure.bbox.x1


def test_space_is_drawn_to_one_scale_not_mirrored_and_with_up_on_top(flight):
    axes = figures.path_figure(flight).axes[0]
    spans = [np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    assert np.allclose(axes._box_aspect / axes._box_aspect[0], np.array(spans) / spans[0])
    signs = [np.sign(b - a) for a, b in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    assert signs == [1, -1, -1]  # two axes turned around: a rotation


def test_the_plans_are_as_wide_and_high_as_what_they_show(flight):
    _, above, side = figures.path_figure(flight).axes
    shown = np.vstack([flight["position"].values, Scene.of(flight).points])
    for axes, (i, j) in ((above, (0, 1)), (side, (0, 2))):
        assert axes.get_aspect() == 1
        for limits, values in ((axes.get_xlim(), shown[:, i]), (axes.get_ylim(), shown[:, j])):
            low, high = sorted(limits)
            assert low < values.min() < values.max() < high
            assert high - low < 1.3 * np.ptp(values)
        assert axes.get_adjustable() == "box"  # or the limits are not those that are drawn


@pytest.mark.parametrize("narrow", [False, True])
def test_no_number_of_y_meets_those_of_x_in_their_corner(flight, narrow):
    if narrow:  # along x, over a small tag
        change = {"start.position": "[0.6, 0, -1.8]", "goal.height": "1.2"}
        flight = simulate(load("crazyflie-2.1", change), duration=2)
    axes = figures.path_figure(flight).axes[0]
    step = np.diff(axes.get_xticks())[0]
    corner = axes.get_ylim()[0]
    assert len(axes.get_yticks()) >= 2
    assert (corner - axes.get_yticks() > 0.4 * step).all()


def test_the_beginning_of_a_motion_is_flown_again_for_more_samples_of_it(x4, flight):
    early = panels.beginning(flight)
    assert early == 15
    first = simulate(x4, duration=early)
    pitch = drawn(figures.motion_figure(flight, first).axes[3], "pitch")
    assert len(pitch.get_xdata()) == 1501  # the flight itself has 21 of them
    again = first["euler_angles"].sel(angle="pitch").sel(time=flight["time"][:20], method="nearest")
    assert np.array_equal(again, flight["euler_angles"].sel(angle="pitch")[:20])


@pytest.mark.parametrize("preset", ["x4-flyer", "crazyflie-2.1"])
def test_the_bounds_are_not_said_to_hold_below_the_ground(preset):
    mission = load(preset)
    axes = region_figure(mission, certify_region(mission, default_box(mission))).axes[0]
    sets = [s for s in axes.collections if s.get_paths() and len(s.get_paths()[0].vertices)]
    assert len(sets) == 2  # what is shaded, and its outline
    for drawn_set in sets:
        z = np.vstack([path.vertices for path in drawn_set.get_paths()])[:, 1]
        assert z.max() <= 0  # z is down
    ground = drawn(axes, "ground").get_ydata()
    assert set(ground) == {0}


def test_a_rotor_s_place_gives_its_torque(flight):
    places = Scene.of(flight).rotor_places
    thrusts = flight["rotor_thrust"].values[0]
    up = np.array([0, 0, -1.0])
    torque = sum(np.cross(p, t * up) for p, t in zip(places, thrusts, strict=True))
    assert np.allclose(torque[:2], flight["torque"].values[0, :2])
    assert np.allclose(np.abs(places[:, :2]), 0.25)


@pytest.mark.slow
def test_figures_of_flights_cut_short_can_be_drawn():
    wild = simulate(load("x4-flyer", {"gains.k1": "200", "gains.k2": "300"}), duration=50)
    assert wild.attrs["outcome"] != "flown"
    assert len(figures.save_figures(wild, Path("wild"))) == 3
    assert len(figures.save_figures(wild.isel(time=slice(0, 1)), Path("instant"))) == 3


@pytest.mark.slow
def test_a_record_is_drawn_as_its_dataset_is(x4):
    record = flown(x4, Timing(duration=1500))
    decay = decay_along(record, hp.certify(x4))
    first = figures.save_figures(record, Path("record"), decay=decay)
    same = figures.save_figures(record.dataset(), Path("dataset"), decay=decay)
    assert decay == decay_along(record.dataset(), hp.certify(x4))
    for one, other in zip(first, same, strict=True):
        assert one.read_bytes() == other.read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["png", "svg"])
def test_a_figure_laid_out_once_is_the_figure_that_savefig_lays_out(flight, ending):
    with mpl.rc_context({"svg.hashsalt": "same"}):
        figures.features_figure(flight).savefig(f"own.{ending}", dpi=style.DPI)
        style.save_figure(figures.features_figure(flight), Path(f"once.{ending}"))
    own, once = (Path(f"{name}.{ending}").read_text("latin-1") for name in ("own", "once"))
    dates = re.compile("<dc:date>.*</dc:date>")
    assert dates.sub("", own) == dates.sub("", once)


def test_the_view_angle_of_a_point_on_the_axis_is_zero(flight):
    centred = flight.assign(image=0 * flight["image"])
    assert (view_angle(centred) == 0).all()


def linear(colour):
    c = np.array(matplotlib.colors.to_rgb(colour))
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("lost", ["long", "middle"])
def test_the_colours_of_a_figure_differ_for_the_colour_blind(lost):
    """Viénot, Brettel and Mollon (1999): what protanopes and deuteranopes see, in linear RGB."""
    seen = {
        "long": [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
        "middle": [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
    }[lost]
    colours = [np.array(seen) @ linear(c) for c in style.COLOURS]
    for i, a in enumerate(colours):
        for b in colours[:i]:
            assert np.linalg.norm(a - b) > 0.08


def test_the_powers_of_ten_of_an_axis_are_written_in_letters():
    """As a formula they would be set by a language of their own, which takes long to start."""
    figure = Figure()
    axes = figure.subplots()
    axes.loglog([1e-3, 20], [0.2, 0.9])
    for axis in (axes.xaxis, axes.yaxis):
        style.plain_powers(axis)
    figure.canvas.draw()
    across = [label.get_text() for label in axes.get_xticklabels()]
    between = [label.get_text() for label in axes.get_yticklabels(minor=True)]
    assert {"10⁻³", "10⁰", "10¹"} <= set(across)
    assert {"2×10⁻¹", "6×10⁻¹"} <= set(between)


@pytest.mark.parametrize(
    ("ends", "said"),
    [
        ((0.9, 21), "1 2 5 10 20"),
        ((3, 310), "3 10 30 100 300"),
        ((0.0002, 0.02), "0.0003 0.001 0.003 0.01"),
        ((1e-4, 1), "10⁻⁴ 10⁻³ 10⁻² 10⁻¹ 10⁰"),
    ],
)
def test_a_short_logarithmic_axis_has_round_numbers(ends, said):
    figure = Figure()
    axes = figure.subplots()
    axes.set(xscale="log", xlim=ends)
    style.round_numbers(axes.xaxis)
    figure.draw_without_rendering()
    labels = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
    assert " ".join(text.get_text() for x, text in labels if ends[0] <= x <= ends[1]) == said
