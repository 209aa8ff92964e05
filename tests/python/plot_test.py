"""Figures: what is drawn, by the numbers, labels and axes that matplotlib has, and not by pixels."""

import io
import json
import math
import os
import shutil
import subprocess
import sys
import warnings

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from conftest import BUILD

import tomlin
from tomlin._plots import command
from tomlin._plots.draw import PageFormat, page, picture

SITE = os.path.abspath(os.path.join(os.path.dirname(tomlin.__file__), ".."))
ENVIRONMENT = {**os.environ, "PYTHONPATH": SITE}

# Rounding of a few operations on numbers around 1.
ROUNDING = 1e-12


def write(folder, **files):
    """A folder of a run or a sweep from the texts of its files; a name has "_" for the dot."""
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        stem, _, suffix = name.rpartition("_")
        (folder / f"{stem}.{suffix}").write_text(
            text if isinstance(text, str) else json.dumps(text), encoding="utf-8")
    return folder


def run(folder, samples=None, status="finished", **files):
    summary = {"status": status, **files.pop("summary", {})}
    if samples is not None:
        files["observables_csv"] = samples
    return write(folder, summary_json=summary, **files)


def table(header, *rows):
    return "\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n"


class Drawn:
    """The axes of a figure, and the notes about it."""

    def __init__(self, canvas, notes):
        self.canvas, self.notes = canvas, notes
        bars = {ax for ax in canvas.axes if hasattr(ax, "_colorbar")}
        self.axes = [ax for ax in canvas.axes if ax not in bars]
        self.bars = [ax for ax in canvas.axes if ax in bars]
        self.ax = self.axes[0]

    def curves(self, panel=0):
        """Label and pieces of each curve; a piece is a list of points."""
        found = []
        for line in self.axes[panel].lines:
            if line.get_label().startswith("_") and not line.get_xdata().size:
                continue
            pieces = [[]]
            for x, y in zip(line.get_xdata(), line.get_ydata()):
                if math.isnan(x) or math.isnan(y):
                    pieces.append([])
                else:
                    pieces[-1].append((float(x), float(y)))
            label = "" if line.get_label().startswith("_child") else line.get_label()
            found.append((label, [piece for piece in pieces if piece]))
        return found

    def labels(self, panel=0):
        return [label for label, _ in self.curves(panel) if label]

    def key(self, panel=0):
        legend = self.axes[panel].get_legend()
        return [text.get_text() for text in legend.get_texts()] if legend else []

    def cells(self):
        """Numbers of a raster, from below."""
        [mesh] = [one for one in self.ax.collections if hasattr(one, "get_coordinates")]
        return np.ma.filled(mesh.get_array().astype(float), np.nan).reshape(
            np.array(mesh.get_coordinates().shape[:2]) - 1)

    def edges(self):
        [mesh] = [one for one in self.ax.collections if hasattr(one, "get_coordinates")]
        at = mesh.get_coordinates()
        return at[0, :, 0], at[:, 0, 1]


@pytest.fixture
def draw(tmp_path, monkeypatch):
    """Draws as the command does, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    caught = []

    def taken(figure, form, suffix):
        caught.append(page(figure, form))
        return b"picture"

    monkeypatch.setattr(command, "picture", taken)

    def drawn(*words):
        notes = command.plot([*map(str, words), "-o", "a.svg"])
        return Drawn(caught.pop(), notes)

    return drawn


def refused(draw, *words):
    """The fault of a command line that is refused."""
    with pytest.raises(tomlin.SceneError) as error:
        draw(*words)
    [fault] = error.value.faults
    assert fault.text.endswith(f"[{fault.code}]")
    return fault


TRACES = ("time [time],driver.force.x [force],driver.force.y [force],driver.position.x [length],"
          "ring.centre_of_mass.x [length]")


@pytest.fixture
def two(tmp_path):
    """Two runs: the first with six samples, which turns back, the second with two."""
    run(tmp_path / "one", table(TRACES, (0, 0, 0, 0, 0), (1, 3, 4, 1, 0.5), (2, -3, 4, 2, 1),
                                (3, 6, 8, 3, 2.5), (4, 1, 0, 2, 2), (5, 2, 0, 1, 1)))
    run(tmp_path / "two", table(TRACES, (0, 0, 0, 0, 0), (1, 1, 1, 4, 3)))
    return "one", "two"


# Curves.

def test_a_curve_for_each_run(draw, two):
    figure = draw(*two, "force_size")
    assert figure.curves() == [
        ("one", [[(0.0, 0.0), (1.0, 5.0), (2.0, -5.0), (3.0, 10.0), (2.0, 1.0), (1.0, 2.0)]]),
        ("two", [[(0.0, 0.0), (4.0, math.sqrt(2.0))]])]
    assert figure.key() == ["one", "two"] and figure.ax.get_xlim() == (0.0, 4.0)
    low, high = figure.ax.get_ylim()
    assert low < -5.0 and high > 10.0
    assert figure.ax.get_ylabel() == "friction force $F_f$"
    assert figure.ax.lines[0].get_color() != figure.ax.lines[1].get_color()
    assert draw("one").key() == []


def test_the_position_beside_a_spring_that_is_not_stretched(draw, two):
    aid, *curves = draw(*two, "position").curves()
    assert aid == ("", [[(0.0, 0.0), (4.0, 4.0)]]) and len(curves) == 2
    assert len(draw(*two, "--x", "time", "--y", "position").curves()) == 2


def test_panels_and_several_curves_of_one_unit(draw, two):
    figure = draw(*two, "--x", "time", "--y", "driver.force.x,driver.force.y", "--y", "position")
    assert figure.labels(0) == ["driver.force.x, one", "driver.force.y, one", "driver.force.x, two",
                                "driver.force.y, two"]
    assert figure.labels(1) == ["one", "two"]
    assert [ax.get_ylabel() for ax in figure.axes] == ["force", "$x_c$"]
    assert [ax.get_xlabel() for ax in figure.axes] == ["", "time $t$"]
    both = draw(*two, "--x", "time", "--y", "force,driver.force.y")
    assert both.labels()[:2] == ["lateral force, one", "driver.force.y, one"]
    # Panels whose curves have the same names share a key.
    same = draw(*two, "--y", "force", "--y", "position")
    assert same.key(0) == ["one", "two"] and same.key(1) == []


def test_a_range_cuts_with_the_lines_that_leave_it(draw, two):
    figure = draw(*two, "--from", 2.5, "--to", 3.5)
    assert figure.curves() == [("one", [[(2.0, -3.0), (3.0, 6.0), (2.0, 1.0)]]), ("two", [])]
    assert figure.ax.get_xlim() == (2.5, 3.5) and figure.ax.get_ylim()[0] > 0.0
    assert draw(*two, "--from", -1, "--to", 0.5).curves()[0][1] == [[(0.0, 0.0), (1.0, 3.0)]]
    assert len(draw(*two, "--from=0.5", "--to", 1.5).curves()[0][1]) == 2  # twice through it
    fault = refused(draw, *two, "--from", 7)
    assert (fault.file, fault.code) == ("--from", "plot.no_data") and "0 to 4" in fault.admissible
    assert refused(draw, "one", "--from", "3", "--to", "2").key == "--from"
    assert draw("one", "--from", "-1e-1").ax.get_xlim()[0] == -0.1


def test_a_level_curve_has_room(draw, tmp_path):
    run(tmp_path / "level", table(TRACES, (0, 2, 0, 0, 0), (1, 2, 0, 1, 0)))
    figure = draw("level", "--x", "time", "--y", "force", "--y", "position")
    for ax, level in zip(figure.axes, (2.0, 0.0)):
        low, high = ax.get_ylim()
        assert low < level < high


def test_numbers_of_two_units_have_no_axis_in_common(draw, two):
    fault = refused(draw, *two, "--y", "force,position")
    assert (fault.code, fault.key) == ("command.invalid_value", "--y position")
    assert "[length]" in fault.message and "force [force]" in fault.message


def test_names_that_are_none_come_with_what_there_is(draw, two, tmp_path):
    fault = refused(draw, "one", "--y", "forse")
    assert (fault.key, fault.nearest) == ("--y forse", "force")
    assert fault.file == "one/observables.csv"
    fault = refused(draw, "one", "speed")
    assert fault.message.endswith("velocity.x") and fault.admissible.startswith("time, driver.force")
    run(tmp_path / "both", table("time [time],left.force.x [force],right.force.x [force]", (0, 1, 2)))
    fault = refused(draw, "both", "--x", "time", "--y", "force")
    assert (fault.code, fault.admissible) == ("command.missing_argument",
                                              "--driver left, --driver right")
    fault = refused(draw, "both", "--driver", "rigth")
    assert (fault.key, fault.nearest) == ("--driver rigth", "right")
    assert draw("both", "--driver", "right").curves()[0][1] == [[(0.0, 2.0)]]


def test_the_support_is_at_v_t_only_where_it_is(draw, two, tmp_path):
    assert draw("one").ax.get_xlabel() == "support position $X$"
    assert draw("two").ax.get_xlabel() == "driver position $vt$"
    assert draw(*two).ax.get_xlabel() == "support position $X$"
    run(tmp_path / "late", table(TRACES, (0, 0, 0, 1, 0), (1, 1, 1, 5, 3), (2, 1, 1, 9, 3)))
    assert draw("late").ax.get_xlabel() == "support position $X$"


def test_a_driver_without_a_support_is_drawn_over_time(draw, tmp_path):
    run(tmp_path / "force", table("time [time],driver.force.x [force]", (0, 1), (1, 2)))
    assert draw("force").ax.get_xlabel() == "time $t$"


def test_logarithmic_axes_break_at_numbers_that_are_not_positive(draw, two, tmp_path):
    figure = draw(*two, "--x", "time", "--y", "force", "--log", "xy")
    assert figure.ax.get_xscale() == figure.ax.get_yscale() == "log"
    assert figure.curves()[0][1] == [[(1.0, 3.0)], [(3.0, 6.0), (4.0, 1.0), (5.0, 2.0)]]
    assert figure.ax.get_xlim() == (1.0, 5.0) and 0.0 < figure.ax.get_ylim()[0] < 1.0
    assert figure.notes == ["3 samples are not positive, and not on a logarithmic axis"]
    assert refused(draw, "one", "--log", "x", "--from", "-1").code == "command.invalid_value"
    run(tmp_path / "below", table(TRACES, (0, -1, 0, 0, 0), (1, -1, 0, 1, 0)))
    assert refused(draw, "below", "--log", "y").key == "force"
    # An axis of few decades has numbers between the powers of ten.
    ticks = [text.get_text() for text in figure.ax.get_xticklabels()]
    assert {"1", "2", "5"} <= set(ticks)


def test_numbers_along_a_short_axis_far_from_zero_differ(draw, tmp_path):
    near = 0.64824922
    run(tmp_path / "short", table("time [time],a [x]", (near, 1), (near + 4e-8, 2)))
    figure = draw("short", "--x", "time", "--y", "a")
    figure.canvas.canvas.draw()
    texts = [text for text in figure.ax.get_xticklabels() if text.get_text()]
    shown = [text.get_text() for text in texts]
    assert len(set(shown)) == len(shown) >= 2 and all(one.startswith("0.6482492") for one in shown)
    boxes = [text.get_window_extent() for text in texts]
    assert all(a.x1 < b.x0 for a, b in zip(boxes, boxes[1:]))


def scale_of(ax):
    """How much longer a length is along y than along x."""
    box = ax.get_window_extent()
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    return box.height / (high - low) * (right - left) / box.width


def test_a_path_is_to_scale(draw, tmp_path):
    header = "time [time],r.centre_of_mass.x [length],r.centre_of_mass.y [length]"
    run(tmp_path / "path", table(header, (0, 0, 0), (1, 4, 1), (2, 8, 0)))
    for size in ([], ["--size", "400x900"], ["--size", "900x300"]):
        figure = draw("path", "path", *size)
        assert scale_of(figure.ax) == pytest.approx(1.0, rel=1e-9)
        assert figure.curves()[0][1] == [[(0.0, 0.0), (4.0, 1.0), (8.0, 0.0)]]
    # The negative control: of two units there is no common scale.
    assert abs(scale_of(draw("path", "--x", "time", "--y", "height").ax) - 1.0) > 0.1


def test_a_long_curve_is_reduced_to_what_is_seen(draw, tmp_path):
    rows, spike = 200000, 77777
    x = np.arange(rows, dtype=float)
    y = np.where(x % 2, -1.0, 1.0)
    y[spike] = 1000.0
    y[spike + 1000] = math.nan
    text = io.StringIO()
    np.savetxt(text, np.stack([x, np.nan_to_num(y), x], axis=1), delimiter=",", fmt="%.17g",
               comments="", header="time [time],d.force.x [force],d.position.x [length]")
    run(tmp_path / "long", text.getvalue())
    figure = draw("long")
    [(_, [points])] = figure.curves()
    assert (float(spike), 1000.0) in points and len(points) <= 6000
    assert points[0] == (0.0, 1.0) and points[-1][0] == rows - 1
    assert {-1.0, 1.0} <= {value for _, value in points}


def test_rounds_of_a_loop_are_drawn_once():
    from tomlin._plots.reduce import MOST_POINTS, Window, reduced

    angle = np.linspace(0.0, 200.0 * math.pi, 300000)
    x, y = np.cos(angle), np.sin(angle)
    x[1234], y[150000] = 1.5, 2.5  # extremes are kept
    window = Window((-1.5, 1.5), (-1.0, 2.5), 540.0, 330.0)
    kept_x, kept_y = reduced(x, y, window)
    assert len(kept_x) <= MOST_POINTS and np.nanmax(kept_x) == 1.5 and np.nanmax(kept_y) == 2.5
    seen = np.floor(np.arctan2(kept_y, kept_x)[~np.isnan(kept_x)] * 10.0)
    assert len(set(seen)) > 60  # of 64: all around
    short = np.arange(1000.0)
    assert reduced(short, short, window)[0] is short
    # A gap stays a gap.
    gap = np.arange(5000.0)
    gap[2500] = math.nan
    window = Window((0.0, 5000.0), (0.0, 5000.0), 540.0, 330.0)
    assert np.isnan(reduced(gap, gap, window)[1]).sum() == 1


# Names and units.

def test_runs_are_named_by_what_differs(draw, tmp_path):
    def named(name, parameters, scene=""):
        run(tmp_path / name, table(TRACES, (0, 0, 0, 0, 0), (1, 1, 1, 4, 3)),
            summary={"parameters": parameters}, scene_toml=scene)
        return name

    a, b = named("a", {"k": 2.0, "v": 10.0, "w": None}), named("b", {"k": 2.0, "v": 9.0})
    assert draw(a, b).key() == ["v = 9", "v = 10"]  # as numbers, in their order
    assert draw(b, a).key() == ["v = 9", "v = 10"]
    assert draw(a, b, "--label", "x, $y_1$", "--label", "_z").key() == [r"x, \$y_1\$", "_z"]
    assert refused(draw, a, b, "--label", "one").message == "1 for 2 folders"
    free, held = named("free", {"k": 2.0}), named("held", {"k": 2.0})
    stiff = named("stiff", {"k": 8.0})
    assert draw(free, held).key() == ["free", "held"]
    assert draw(free, held, stiff).key() == ["free", "held", "k = 8"]
    assert draw(named("c", {"k": 2.0 + 1e-9}), free).key() == ["free", "c"]  # beyond the digits
    # Folders of one name go by their paths.
    (tmp_path / "older").mkdir()
    named("older/free", {"k": 2.0})
    assert draw(free, "older/free").key() == ["free", "older/free"]
    # A parameter that follows from another one is left out.
    written = [named(f"w{v}", {"v": v, "two": 2.0 * v}, f'[parameters]\nv = {v}\ntwo = "2 * v"\n')
               for v in (1.0, 3.0)]
    assert draw(*written).key() == ["v = 1", "v = 3"]


def test_units_are_those_that_the_scene_names(draw, tmp_path):
    rows = table(TRACES, (0, 0, 0, 0, 0), (1, 1, 1, 4, 3))
    axes = {"length": "a", "force": "V_0/a", "time": "t $0"}
    run(tmp_path / "named", rows, summary={"scene": {"axes": axes}})
    run(tmp_path / "bare", rows)
    figure = draw("named")
    assert figure.ax.get_ylabel() == r"lateral force $F_x$ / ($\mathregular{V_{0}}$/a)"
    assert figure.ax.get_xlabel() == "driver position $vt$ / a"
    assert draw("named", "--x", "time", "--y", "driver.force.x,driver.force.y").ax.get_ylabel() == (
        r"force / ($\mathregular{V_{0}}$/a)")
    assert draw("named", "--x", "time", "--y", "ring.centre_of_mass.x").ax.get_xlabel() == (
        r"time $t$ / (t \$0)")
    assert draw("bare", "--x", "time", "--y", "ring.centre_of_mass.x").ax.get_ylabel() == (
        "ring.centre_of_mass.x")
    fault = refused(draw, "bare", "named")
    assert (fault.code, fault.key) == ("command.conflict", "scene.axes")
    assert fault.file == "bare/summary.json" and "no name" in fault.message
    header = "time [ps],d.force.x [eV/A],d.position.x [A],b.velocity.x [A/ps],k [eV/A^2]"
    run(tmp_path / "metal", table(header, (0, 0, 0, 0, 0), (1, 1, 1, 1, 1)),
        summary={"scene": {"units": "metal"}})
    assert draw("metal").ax.get_ylabel() == "lateral force $F_x$ / (eV/\u00c5)"
    assert draw("metal", "--y", "k").ax.get_ylabel() == r"k / (eV/$\mathregular{\u00c5^{2}}$)".replace(
        r"\u00c5", "\u00c5")
    assert draw("metal", "--y", "d.position.x,d.position.x").ax.get_ylabel() == "length / \u00c5"
    run(tmp_path / "hot", summary={"scene": {"units": "metal"}, "parameters": {"T": 300.0},
                                   "bodies": {"b": {"temperature": 290.0}}})
    hot = draw("hot", "--result", "b.temperature", "--against", "T")
    assert hot.ax.get_ylabel() == "temperature / K"
    assert refused(draw, "metal", "bare").code in ("command.conflict", "command.invalid_value")


# Loops.

def loop_table(*rows, header="time [time],d.force.x [force],d.position.x [length]"):
    return table(header, *rows)


def test_a_loop_has_an_arrow_for_each_direction(draw, tmp_path):
    rows = [(0, 0, 0), *((i, 1, i) for i in range(1, 5)), *((i, -1, 8 - i) for i in range(5, 9)),
            (9, 1, 1), (10, 1, 2)]
    run(tmp_path / "loop", loop_table(*rows))
    figure = draw("loop", "loop")
    assert figure.curves() == [("", [[(float(x), float(y)) for _, y, x in rows]])]
    assert figure.ax.get_xlabel() == "support position $X$"
    assert figure.ax.get_ylabel() == "lateral force $F_x$"
    forward, back = figure.ax.texts
    assert forward.xy[0] > forward.xyann[0] and forward.xy[1] == forward.xyann[1] == 1.0
    assert back.xy[0] < back.xyann[0] and back.xyann[1] == -1.0


def test_a_loop_is_along_the_pull_wherever_that_points(draw, tmp_path):
    """A run along (3, 4)/5 and one along x give one loop; a force across it does not count."""
    rows = [(0, 0, 0), (1, 1, 2), (2, 1, 4), (3, -1, 2), (4, -1, 0)]
    run(tmp_path / "plane", loop_table(
        *((t, 0.6 * f - 0.8, 0.8 * f + 0.6, 0.6 * x, 0.8 * x) for t, f, x in rows),
        header="time [time],d.force.x [force],d.force.y [force],d.position.x [length],"
        "d.position.y [length]"))
    figure = draw("plane", "loop")
    [(_, [points])] = figure.curves()
    assert np.allclose(points, [(x, f) for _, f, x in rows], rtol=0.0, atol=ROUNDING)
    assert "along the pull" in figure.ax.get_xlabel()
    # A driver that begins to the left pulls to the left.
    run(tmp_path / "left", loop_table(*((t, -f, -x) for t, f, x in rows)))
    assert draw("left", "loop").curves()[0][1][0][2] == (4.0, 1.0)


def test_what_is_no_loop_is_refused(draw, tmp_path):
    run(tmp_path / "way", loop_table((0, 0, 0), (1, 1, 1), (2, 1, 2)))
    run(tmp_path / "rest", loop_table((0, 0, 1), (1, 1, 1)))
    run(tmp_path / "none", table("time [time],d.force.x [force]", (0, 1), (1, 2)))
    assert "reverses" in refused(draw, "way", "loop").admissible
    assert refused(draw, "rest", "loop").key == "d.position"
    assert refused(draw, "none", "loop").code == "plot.no_data"


# Bodies.

RING = """[[body]]
name = "ring"
type = "ring"
count = 4
radius = 2.0
centre = [0.0, 2.0]
particle_mass = 1.0
coordinates = "rigid"

[[force]]
type = "constant_force"
force = [0.1, 0.0]

[run]
duration = 1.0
integrator = { type = "rk4", dt = 0.1 }
"""


@pytest.fixture
def ring(tmp_path):
    """A quarter turn backwards while the ring moves by 6, the driver by 8."""
    header = ("time [time],driver.position.x [length],driver.position.y [length],"
              "ring.centre_of_mass.x [length],ring.centre_of_mass.y [length],ring.rotation [rad]")
    rows = table(header, (0, 0, 2, 0, 2, 0), (10, 8, 2, 6, 3, -math.pi / 2))
    return run(tmp_path / "ring", rows, scene_toml=RING)


def test_a_ring_has_particles_centre_and_driver(draw, ring):
    figure = draw("./ring", "ring", "--at", "10", "--label", "turned")
    (label, [particles]), (_, [[first]]), (_, [[centre]]), (_, [[driver]]) = figure.curves()[:4]
    assert label == "t = 10" and figure.ax.get_title() == "turned"
    expected = [(6.0, 1.0), (8.0, 3.0), (6.0, 5.0), (4.0, 3.0), (6.0, 1.0)]  # the last closes it
    assert np.allclose(particles, expected, rtol=0.0, atol=ROUNDING)
    assert first == particles[0] and centre == (6.0, 3.0) and driver == (8.0, 2.0)
    assert figure.key() == ["t = 10", "particle 0", "centre of mass", "driver"]
    assert scale_of(figure.ax) == pytest.approx(1.0, rel=1e-9) and not figure.notes


def test_a_ring_between_samples_and_by_another_clock(draw, ring):
    half = draw("./ring", "ring", "--at", "5").curves()
    side = 2.0 * math.cos(math.pi / 4)
    assert np.allclose(half[0][1][0][0], (3.0 + side, 2.5 - side), rtol=0.0, atol=ROUNDING)
    by_driver = draw("./ring", "ring", "--x", "driver_position", "--at", "4").curves()
    assert by_driver[0][0] == "vt = 4" and by_driver[2][1] == half[2][1]
    # The first sample with the value counts, also of a quantity that falls, as the rotation.
    falls = draw("./ring", "ring", "--x", "rotation", "--at", -math.pi / 4).curves()
    assert np.allclose(falls[2][1], half[2][1], rtol=0.0, atol=ROUNDING)
    five = draw("./ring", "ring")
    assert [one for one in five.key() if one.startswith("t = ")] == [
        "t = 0", "t = 2.5", "t = 5", "t = 7.5", "t = 10"]


def test_a_ring_refuses_what_is_not_there(draw, ring):
    fault = refused(draw, "./ring", "ring", "--at", "10.5")
    assert (fault.file, fault.key) == ("--at", "10.5") and "0 to 10" in fault.admissible
    assert refused(draw, "./ring", "ring", "--at=-1").key == "-1"
    assert refused(draw, "./ring", "ring", "--body", "rong").nearest == "ring"
    (ring / "scene.toml").write_text(RING.replace('"rigid"', '"particles"'), encoding="utf-8")
    assert "ring is flexible" in draw("./ring", "ring", "--at", "1").notes[0]
    (ring / "scene.toml").write_text("", encoding="utf-8")
    assert refused(draw, "./ring", "ring").code == "file.invalid"


GROUND = """
[[force]]
name = "ground"
type = "sinusoidal_substrate"
body = "ring"
amplitude = 0.25
period = 2.0
decay = 0.125
"""


def surface_run(tmp_path, forces):
    header = "time [time],ring.centre_of_mass.x [length],ring.centre_of_mass.y [length]"
    scene = RING.replace('type = "constant_force"', 'name = "push"\ntype = "constant_force"')
    run(tmp_path / "surface", table(header, (0, 0, 0), (1, 1, 0.5), (2, 4, 1)),
        scene_toml=scene.replace("[run]", forces + "\n[run]"))
    return "./surface", "surface"


def test_a_surface_is_the_potential_of_one_particle(draw, tmp_path):
    """V_0 exp(-c y^2) cos(2 pi x / a), and not that of the ring's four particles."""
    words = surface_run(tmp_path, GROUND)
    figure = draw(*words)
    x_edges, y_edges = figure.edges()
    x, y = 0.5 * (x_edges[1:] + x_edges[:-1]), 0.5 * (y_edges[1:] + y_edges[:-1])
    exact = 0.25 * np.exp(-0.125 * y[:, None] ** 2) * np.cos(math.pi * x)
    assert np.allclose(figure.cells(), exact, rtol=0.0, atol=1e-14)
    assert len(x) > 100 and np.diff(x)[0] == pytest.approx(np.diff(y)[0], rel=0.02)
    assert x_edges[0] < -1.0 and x_edges[-1] > 5.0
    assert figure.curves()[0] == ("path", [[(0.0, 0.0), (1.0, 0.5), (4.0, 1.0)]])
    assert figure.bars[0].get_ylabel() == "potential energy $V$"
    assert scale_of(figure.ax) == pytest.approx(1.0, rel=1e-9)
    assert len(draw(*words, "--from", "0.5").curves()[0][1][0]) == 2
    assert refused(draw, *words, "--from", "7").code == "plot.no_data"
    # Substrates add up, and what all particles have together is shared out by their count.
    twice = draw(*surface_run(tmp_path, GROUND + GROUND.replace('"ground"', '"second"'))).cells()
    assert (twice == 2.0 * figure.cells()).all()
    shared = draw(*surface_run(tmp_path, GROUND.replace("= 0.25", '= "1.0 / count"'))).cells()
    assert (shared == figure.cells()).all()


@pytest.mark.parametrize("force", [
    GROUND.replace("0.25", '"0.1 * random(3, i)"'), GROUND.replace("0.25", "[0.1, 0.2, 0.1, 0.1]"),
    *('\n[[force]]\nname = "ground"\ntype = "expression"\nbody = "ring"\nperiod = [2.0, 0.0]\n'
      f'energy = "0.25 * cos(pi*x) / {part}"\n' for part in ("(1 + i)", "count"))])
def test_a_surface_refuses_what_differs_between_particles(draw, tmp_path, force):
    assert refused(draw, *surface_run(tmp_path, force)).key == "force.ground"


def test_a_surface_needs_a_substrate(draw, tmp_path):
    assert refused(draw, *surface_run(tmp_path, "")).key == "body.ring"
    assert "own" in refused(draw, "./surface", "./surface", "surface").message


# Slips.

SLIPS = "time [time],event,name,duration [time],size,energy_lost [energy],peak_force [force]\n"


def heights(figure):
    """The heights of the bars."""
    [(_, [points])] = figure.curves()
    return [y for _, y in points[1:-1:2]]


def test_slips_are_counted_and_nothing_else(draw, tmp_path):
    run(tmp_path / "run", events_csv=SLIPS + "1,slip,d,0.1,1,0.5,0.6\n2,slip,d,0.1,2,,0.6\n"
        "2.5,reversal,d,0.1,100,,\n3,slip,d,0.1,2,0.7,0.6\n4,turn,\"a, b\",0,1,,\n"
        "5,slip,d,0.1,5,0.9,0.7\n")
    figure = draw("run", "slips", "--bins", "4")
    assert heights(figure) == [1.0, 2.0, 0.0, 1.0]  # edges at 1, 2, 3, 4, 5
    assert figure.ax.get_xlabel() == "size of a slip" and figure.ax.get_ylabel() == "number of slips"
    assert heights(draw("run", "slips", "--bins", "2", "--value", "energy")) == [1.0, 2.0]
    assert heights(draw("run", "slips", "--bins", "2", "--value", "peak_force")) == [3.0, 1.0]
    ratios = draw("run", "slips", "--bins", "2", "--log", "x")
    [(_, [line])] = ratios.curves()
    assert line[2][0] / line[1][0] == pytest.approx(line[4][0] / line[3][0], rel=ROUNDING)
    assert heights(ratios) == [3.0, 1.0]
    assert refused(draw, "run", "slips", "--value", "height").admissible == "size, peak_force, energy"


def test_slips_of_several_drivers(draw, tmp_path):
    run(tmp_path / "run", events_csv=SLIPS + "1,slip,d,0.1,1,0.5,0.6\n2,slip,e,0.1,2,,0.6\n")
    assert refused(draw, "run", "slips").admissible == "--driver d, --driver e"
    assert sum(heights(draw("run", "slips", "--driver", "e"))) == 1.0
    assert refused(draw, "run", "slips", "--driver", "f").code == "plot.no_data"
    for events, code, line in (("a,b\n1,2\n", "file.invalid", 1), (SLIPS + "1,slip,d\n",
                               "file.damaged", 2), (SLIPS + "1,slip,d,0.1,x,0.5,0.6\n",
                               "file.damaged", 2)):
        (tmp_path / "run" / "events.csv").write_text(events, encoding="utf-8")
        fault = refused(draw, "run", "slips")
        assert (fault.code, fault.line) == (code, line)


# Images.

SCAN = "time [time],d.force.x [force],d.position.x [length],d.position.y [length]"
IMAGE = ("raster", "--x", "d.position.x", "--y", "d.position.y", "--value", "d.force.x")


@pytest.fixture
def lines(tmp_path):
    """Three scan lines at y = 0, 0.5 and 1, forward with a force of x + 10 y and back with -1."""
    for y in (1.0, 0.0, 0.5):
        x = [0.5 * i if i <= 8 else 0.5 * (16 - i) for i in range(17)]
        run(tmp_path / f"line_{y}", table(SCAN, *(
            (i, x[i] + 10.0 * y if i <= 8 else -1.0, x[i], y) for i in range(17))))
    return "line_1.0", "line_0.0", "line_0.5"


def test_pixels_have_the_mean_of_their_samples(draw, lines):
    figure = draw(*lines, *IMAGE, "--scan", "forward", "--pixels", "2x3")
    # x = 0 to 1.5 and 2 to 4, on lines from below; the means are exact in binary.
    assert figure.cells().tolist() == [[0.75, 3.0], [5.75, 8.0], [10.75, 13.0]]
    assert figure.ax.get_ylim() == (-0.25, 1.25)  # lines are in the middle of their rows
    assert scale_of(figure.ax) > 0.0 and not figure.notes
    assert figure.bars[0].get_ylabel() == "force $F_x$"
    assert figure.ax.get_ylabel() == "support position $y$"
    assert (draw(*lines, *IMAGE, "--scan", "backward", "--pixels", "2x3").cells() == -1.0).all()
    both = draw(*lines, *IMAGE, "--pixels", "2x3").cells()[0, 0]
    assert -1.0 < both < 0.75
    # By default there are two samples to a pixel: here 27 in 3 rows.
    assert draw(*lines, *IMAGE, "--scan", "forward").cells().shape == (3, 4)
    fine = draw(*lines, *IMAGE, "--scan", "forward", "--pixels", "40x3")
    assert np.isnan(fine.cells()).sum() == 120 - 27
    assert fine.notes == ["93 of 120 pixels (40x3) have no sample in them and stay white"]


def test_a_slow_axis_has_a_row_for_each_stroke(draw, tmp_path):
    strokes, per_stroke = 10, 60
    x = [min(i % (2 * per_stroke), 2 * per_stroke - i % (2 * per_stroke))
         for i in range(strokes * per_stroke + 1)]
    run(tmp_path / "scan", table(SCAN, *((i, at, at, 0.001 * i) for i, at in enumerate(x))))
    assert draw("scan", *IMAGE, "--scan", "forward").cells().shape[0] == strokes / 2
    assert draw("scan", *IMAGE).cells().shape[0] == strokes


def test_what_is_no_image_is_refused(draw, lines):
    assert refused(draw, "line_0.0", *IMAGE).key == "d.position.y"  # one line
    over_time = ("raster", "--x", "time", "--y", "d.position.y", "--value")
    assert refused(draw, *lines, *over_time, "d.forse.x").nearest == "d.force.x"
    assert refused(draw, *lines, *over_time, "d.force.x", "--scan", "backward").key == "backward"
    assert refused(draw, *lines, "raster", "--x", "time", "--y", "time").key == "--value"
    assert refused(draw, *lines, *IMAGE, "--pixels", "0x3").admissible == "1 to 1000"
    assert "forward" in refused(draw, *lines, *IMAGE, "--scan", "up").admissible


# Results.

def point(tmp_path, name, v, k, force, error=None):
    run(tmp_path / name, summary={
        "parameters": {"v": v, "k": k}, "drivers": {"d": {"mean_force": [force]}},
        "events": {"slips": 10.0 * v},
        **({"error": {"drivers": {"d": {"mean_force": [error]}}}} if error else {})})
    return name


LAW = ("--result", "d.mean_force.x", "--against")


def test_a_point_for_each_run_with_its_error(draw, tmp_path):
    words = [point(tmp_path, "a", 10.0, 2.0, 0.3, 0.02), point(tmp_path, "b", 9.0, 2.0, 0.2, 0.01)]
    figure = draw(*words, *LAW, "v")
    assert figure.curves()[0] == ("", [[(9.0, 0.2), (10.0, 0.3)]])
    assert figure.ax.get_xlabel() == r"$\mathit{v}$"
    assert figure.ax.get_ylabel() == "mean force along $x$"
    [bars] = [one for one in figure.ax.collections if hasattr(one, "get_segments")]
    assert np.allclose([segment[:, 1] for segment in bars.get_segments()],
                       [(0.19, 0.21), (0.28, 0.32)], rtol=0.0, atol=ROUNDING)
    assert figure.ax.get_ylim()[0] < 0.19 and figure.ax.get_ylim()[1] > 0.32


def test_another_parameter_makes_curves(draw, tmp_path):
    words = [point(tmp_path, f"p{i}", *one) for i, one in enumerate([
        (1.0, 10.0, 1.0), (2.0, 9.0, 4.0), (2.0, 10.0, 2.0), (1.0, 9.0, 3.0)])]
    figure = draw(*words, *LAW, "v")
    assert figure.curves() == [("k = 9", [[(1.0, 3.0), (2.0, 4.0)]]),
                               ("k = 10", [[(1.0, 1.0), (2.0, 2.0)]])]
    # The parameter with the most values varies along a result.
    words.append(point(tmp_path, "more", 3.0, 9.0, 5.0))
    assert draw(*words, *LAW, "events.slips").curves()[0][1][0][2] == (30.0, 5.0)
    # A parameter that all runs have alike joins none of them.
    alike = [point(tmp_path, "s", 1.0, 2.0, 0.3), point(tmp_path, "t", 3.0, 2.0, 0.2)]
    assert draw(*alike, *LAW, "k").labels() == ["v = 1", "v = 3"]


def test_undefined_results_are_left_out(draw, tmp_path):
    words = [point(tmp_path, "a", 1.0, 2.0, None), point(tmp_path, "b", 2.0, 2.0, -1.0),
             point(tmp_path, "c", 3.0, 2.0, 1.0)]
    figure = draw(*words, *LAW, "v", "--log=xy")
    assert figure.curves()[0][1] == [[(3.0, 1.0)]] and len(figure.notes) == 2
    assert refused(draw, "a", *LAW, "v").code == "plot.no_data"
    fault = refused(draw, "c", "--result", "d.mean_forse.x", "--against", "v")
    assert (fault.nearest, fault.file) == ("d.mean_force.x", "c/summary.json")
    assert refused(draw, "c", *LAW, "vv").key == "--against vv"
    assert refused(draw, "c", "--result", "d.mean_force.x").key == "--against"
    assert refused(draw, "c", "speed", *LAW, "v").key == "speed"


# Sweeps.

FORCE = "d.mean_force.x [force]"


def sweep(folder, axes, header, rows, **summary):
    """`axes`: name, dimension, spacing and count or values of each."""
    entries = []
    for name, dimension, values in axes:
        spacing = values if isinstance(values, str) else "list"
        entries.append({"name": name, "dimension": dimension, "spacing": spacing,
                        **({} if isinstance(values, str) else {"values": values})})
    lines = [header + ",status,reason", *rows]
    return write(folder, sweep_csv="\n".join(lines) + "\n",
                 sweep_json={"axes": entries, "points": len(rows), **summary},
                 scene_toml='[scene]\naxes = { force = "V_0/a" }\n')


def two_axes(folder, force):
    """Over v = 1, 10, 100 and k = 4, 1, 2; where the number is NaN the point has failed."""
    rows = []
    for v in (1.0, 10.0, 100.0):
        for k in (4.0, 1.0, 2.0):
            number = force(v, k)
            rows.append(f'{v},{k},,failed,"step 0, a ""cause"""' if math.isnan(number) else
                        f"{v},{k},{number!r},finished,")
    return sweep(folder, [("v", 0, "logarithmic"), ("k", 1, [4.0, 1.0, 2.0])], f"v,k,{FORCE}", rows)


def total(v, k):
    return v + k


def test_a_sweep_over_one_axis_is_a_curve(draw, tmp_path):
    sweep(tmp_path / "s", [("v", 0, "logarithmic")], f"v,{FORCE},error.{FORCE}",
          ["1,3,0.5,finished,", "10,5,,finished,", "100,4,1,finished,"])
    figure = draw("s")
    assert figure.curves()[0] == ("", [[(1.0, 3.0), (10.0, 5.0), (100.0, 4.0)]])
    assert figure.ax.get_ylabel() == r"mean force along $x$ / ($\mathregular{V_{0}}$/a)"
    assert (figure.ax.get_xscale(), figure.ax.get_yscale()) == ("log", "linear")
    [bars] = [one for one in figure.ax.collections if hasattr(one, "get_segments")]
    ends = [segment[:, 1].tolist() for segment in bars.get_segments() if len(segment)]
    assert [one for one in ends if not math.isnan(one[0])] == [[2.5, 3.5], [3.0, 5.0]]
    error = draw("s", "--y", f"error.{FORCE.split()[0]}")
    assert error.ax.get_ylabel().startswith("error of the mean force along $x$")
    assert [one[1] for one in error.curves()] == [[[(1.0, 0.5)], [(100.0, 1.0)]]]


def test_axes_are_logarithmic_as_grids_are(draw, tmp_path):
    two_axes(tmp_path / "s", total)
    for log, expected in ((None, "x"), ("none", ""), ("y", "y"), ("xy", "xy")):
        for words in ([], ["--y", "d.mean_force.x"]):
            ax = draw("s", *words, *(["--log", log] if log else [])).ax
            found = ("x" if ax.get_xscale() == "log" else "") + ("y" if ax.get_yscale() == "log" else "")
            assert found == expected


def test_a_map_has_a_cell_around_each_point(draw, tmp_path):
    two_axes(tmp_path / "s", total)
    figure = draw("s")
    # Upwards k = 1, 2, 4, whatever their order in the sweep.
    cells = [[2.0, 11.0, 101.0], [3.0, 12.0, 102.0], [5.0, 14.0, 104.0]]
    assert figure.cells().tolist() == cells
    x_edges, y_edges = figure.edges()
    assert y_edges.tolist() == [0.5, 1.5, 3.0, 5.0]
    assert np.allclose(x_edges, 10.0 ** np.arange(-0.5, 3.0), rtol=ROUNDING)
    assert figure.ax.get_xlim() == (x_edges[0], x_edges[-1])
    assert figure.bars[0].get_ylabel() == r"mean force along $x$ / ($\mathregular{V_{0}}$/a)"
    for words in (["--x", "k"], ["--y", "v"]):
        turned = draw("s", *words)
        assert turned.cells().tolist() == np.transpose(cells).tolist()
        assert (turned.ax.get_xscale(), turned.ax.get_yscale()) == ("linear", "log")


def test_cells_of_points_without_a_number_stay_white(draw, tmp_path):
    two_axes(tmp_path / "s", lambda v, k: math.nan if (v, k) == (10.0, 2.0) else v + k)
    figure = draw("s")
    assert np.isnan(figure.cells()).tolist() == [[False] * 3, [False, True, False], [False] * 3]
    assert figure.notes == ["1 of 9 numbers are undefined, and their cells stay white"]
    curve = draw("s", "--y", "d.mean_force.x", "--at", "k=2")  # it breaks there
    assert curve.curves()[0][1] == [[(1.0, 3.0)], [(100.0, 102.0)]]
    assert curve.ax.get_title() == "k = 2"
    assert curve.notes == ["1 of 3 numbers are undefined, and left out"]
    two_axes(tmp_path / "s", lambda v, k: math.nan)
    assert refused(draw, "s").code == "plot.no_data"


def test_the_line_goes_through_the_least_values(draw, tmp_path):
    """(log_2 k - log_10 v)^2 is least where k = 2^(log_10 v)."""
    def valley(v, k):
        return (math.log2(k) - math.log10(v)) ** 2

    two_axes(tmp_path / "s", valley)
    figure = draw("s", "--minimum-along", "k")
    assert figure.curves() == [("minimum along k", [[(1.0, 1.0), (10.0, 2.0), (100.0, 4.0)]])]
    assert figure.notes == ["at 2 of 3 values of v the least number is at an end of k"]
    other = draw("s", "--minimum-along", "v")
    assert other.curves()[0][1] == figure.curves()[0][1]
    # Failed points are no minimum; where all have failed, the line breaks.
    two_axes(tmp_path / "s", lambda v, k: math.nan if v == 10.0 or (v, k) == (1.0, 1.0)
             else valley(v, k))
    broken = draw("s", "--minimum-along", "k")
    assert broken.curves()[0][1] == [[(1.0, 2.0)], [(100.0, 4.0)]]


def test_curves_one_for_each_value_of_the_other_axis(draw, tmp_path):
    two_axes(tmp_path / "s", total)
    for words in (["--y", "drivers.d.mean_force.x", "--x", "k"],
                  ["--result", "d.mean_force.x", "--against", "k"]):
        assert draw("s", *words).curves()[1] == ("v = 10", [[(1.0, 11.0), (2.0, 12.0), (4.0, 14.0)]])
    # Words name curves, and are no axis.
    sweep(tmp_path / "w", [("type", 0, ["a, b", "c"]), ("v", 1, [1.0, 2.0])], f"type,v,{FORCE}",
          ['"a, b",1,3,finished,', '"a, b",2,4,finished,', '"c",1,5,finished,', '"c",2,6,finished,'])
    assert draw("w").curves() == [("type = a, b", [[(1.0, 3.0), (2.0, 4.0)]]),
                                  ("type = c", [[(1.0, 5.0), (2.0, 6.0)]])]
    assert refused(draw, "w", "--x", "type").code == "command.conflict"
    assert draw("w", "--at", "type=c").ax.get_title() == "type = c"


def test_zipped_axes_are_one(draw, tmp_path):
    sweep(tmp_path / "s", [("v", 0, [3.0, 1.0, 2.0]), ("k", 0, [5.0, 5.0, 7.0])], f"v,k,{FORCE}",
          ["3,5,9,finished,", "1,5,7,finished,", "2,7,8,finished,"])
    assert draw("s").curves()[0][1] == [[(1.0, 7.0), (2.0, 8.0), (3.0, 9.0)]]
    assert draw("s", "--x", "k").ax.get_xlabel() == r"$\mathit{k}$"
    assert refused(draw, "s", "--x", "k", "--y", "v").key == "v"


def test_refined_sweeps_are_curves(draw, tmp_path):
    rows = ['"a, b",8,5,1', '"a, b",8,7,2', '"a, b",6,7,9', '"a, b",4,5,3', '"a, b",4,7,4',
            '"a, b",0,5,5', '"a, b",0,7,6', '"c",8,5,7', '"c",4,5,', '"c",4,7,2', '"c",0,5,0']
    sweep(tmp_path / "s", [("q", 0, ["a, b", "c"]), ("v", 1, "linear"), ("k", 2, [5.0, 7.0])],
          f"q,v,k,{FORCE}", [f"{row},finished," for row in rows], refine={"along": "v"})
    assert draw("s").curves() == [
        ("q = a, b, k = 5", [[(0.0, 5.0), (4.0, 3.0), (8.0, 1.0)]]),
        ("q = a, b, k = 7", [[(0.0, 6.0), (4.0, 4.0), (6.0, 9.0), (8.0, 2.0)]]),
        ("q = c, k = 5", [[(0.0, 0.0)], [(8.0, 7.0)]]), ("q = c, k = 7", [[(4.0, 2.0)]])]
    # Over another axis a point that has no other value of it is a curve by itself.
    assert draw("s", "--x", "k", "--at", "q=c").labels() == ["v = 8", "v = 4", "v = 0"]
    for words in (["--value", "d.mean_force.x"], ["--y", "k"]):
        fault = refused(draw, "s", *words)
        assert (fault.code, fault.key) == ("command.conflict", "v")


def test_of_more_axes_the_others_are_fixed(draw, tmp_path):
    values = [(a, b, c) for a in (1, 2) for b in (0.01, 0.0316227766, 0.1) for c in (1, 2)]
    sweep(tmp_path / "s", [("a", 0, [1, 2]), ("b", 1, "logarithmic"), ("c", 2, [1, 2])],
          f"a,b,c,{FORCE}", [f"{a},{b},{c},{a + b + c!r},finished," for a, b, c in values])
    fault = refused(draw, "s")
    assert fault.code == "command.missing_argument" and "--at" in fault.admissible
    assert "a (2 values), b (3 values), c (2 values)" in fault.message
    figure = draw("s", "--at", "b=0.0316")
    assert figure.ax.get_title() == "b = 0.0316228"
    assert figure.cells()[0, 1] == 2.0 + 0.0316227766 + 1.0
    assert refused(draw, "s", "--at", "b=0.0316", "--x", "b").key == "b"
    for wrong in ("b=0.03", "b=x", "b=nan"):
        assert refused(draw, "s", "--at", wrong).key == wrong
    assert refused(draw, "s", "--at", "b=0.1,b=0.01").key == "--at"
    assert draw("s", "--y", "d.mean_force.x").labels()[-1] == "b = 0.1, c = 2"


def test_panels_and_units_of_sweeps(draw, tmp_path):
    sweep(tmp_path / "s", [("v", 0, [1.0, 2.0])], f"v,{FORCE},d.max_force.x [force],events.slips [1]",
          ["1,3,4,5,finished,", "2,4,6,7,finished,"])
    figure = draw("s", "--y", "d.mean_force.x,d.max_force.x", "--y", "events.slips")
    assert figure.labels(0) == ["d.mean_force.x", "d.max_force.x"]
    assert figure.axes[0].get_ylabel() == r"force / ($\mathregular{V_{0}}$/a)"
    assert figure.curves(1)[0][1] == [[(1.0, 5.0), (2.0, 7.0)]]
    assert refused(draw, "s", "--y", "d.mean_force.x,events.slips").key == "--y events.slips"


def test_sweeps_name_what_there_is(draw, tmp_path):
    two_axes(tmp_path / "s", total)
    for words, key, code in ((["--value", "d.mean_forse.x"], "d.mean_forse.x", "plot.no_data"),
                             (["--x", "vv"], "vv", "plot.no_data"),
                             (["--minimum-along", "d"], "d", "plot.no_data"),
                             (["--y", "d.mean_force.x", "--value", "d.mean_force.x"], "--value",
                              "command.conflict"),
                             (["--x", "k", "--y", "k"], "k", "command.conflict"),
                             (["--at", "3"], "--at", "command.invalid_value"),
                             (["--against", "k"], "--result", "command.missing_argument"),
                             (["--label", "a"], "--label", "command.conflict"),
                             (["force"], "force", "command.conflict")):
        fault = refused(draw, "s", *words)
        assert (fault.key, fault.code) == (key, code)


def test_a_map_shows_each_value_once_and_no_zero_on_a_logarithmic_axis(draw, tmp_path):
    sweep(tmp_path / "s", [("v", 0, [0.0, 1.0]), ("k", 1, [1.0, 2.0])], f"v,k,{FORCE}",
          ["0,1,1,finished,", "0,2,2,finished,", "1,1,-3,finished,", "1,2,4,finished,"])
    assert refused(draw, "s", "--log", "x").key == "v"
    figure = draw("s", "--log", "xy", "--y", "d.mean_force.x")
    assert figure.curves()[1][1] == [[(1.0, 4.0)]]
    assert figure.notes == ["3 of 4 numbers are not positive, and not on a logarithmic axis"]
    sweep(tmp_path / "t", [("v", 0, [1.0, 1.0]), ("k", 1, [1.0, 2.0])], f"v,k,{FORCE}",
          ["1,1,1,finished,", "1,2,2,finished,"] * 2)
    fault = refused(draw, "t", "--x", "v", "--y", "k")
    assert (fault.key, fault.code) == ("v", "command.conflict")


def test_files_of_a_sweep_that_do_not_belong_together(draw, tmp_path):
    folder = two_axes(tmp_path / "s", total)
    whole, summary = (folder / "sweep.csv").read_text(), (folder / "sweep.json").read_text()
    for csv, code in ((whole.replace("100.0,2.0,102.0,finished,\n", ""), "file.damaged"),
                      (whole.replace("v,k,", "v,w,"), "file.damaged"),
                      ("time [time]\n", "file.invalid"), (whole[:-3], "file.damaged"),
                      (whole.replace("11.0", "x"), "file.damaged")):
        (folder / "sweep.csv").write_text(csv)
        assert refused(draw, "s").code == code
    (folder / "sweep.csv").write_text(whole)
    for text in ("{}", "[]", "{", '{"axes": 3, "points": 9}', "[" * 100000):
        (folder / "sweep.json").write_text(text)
        assert refused(draw, "s").code == "file.invalid"
    (folder / "sweep.json").write_text(summary)
    (folder / "scene.toml").unlink()
    assert draw("s").bars[0].get_ylabel() == "mean force along $x$"
    (folder / "sweep.csv").rename(folder / "sweep.journal")
    assert "not finished" in refused(draw, "s").message


# Studies.

def test_the_work_precision_diagram(draw, tmp_path):
    def at(rung, cost, error):
        return {"rung": rung, "cost": cost, "error": error}

    tradeoff = {"observable": "drivers.d.mean_force.x", "tolerance": 1e-3, "relative": True,
                "error_unit": 2.0, "reference": {"error": 2e-6},
                "points": [at("rk4", 10, 0.2), at("rk4", 1000, 2e-9), at("rk4 in float", 20, 2e-4)],
                "recommendation": at("rk4 in float", 20, 2e-4)}
    write(tmp_path / "t", tradeoff_json=tradeoff)
    figure = draw("t")
    curves = dict(figure.curves())
    assert curves["rk4"] == [[(10.0, 0.1), (1000.0, 1e-7)]]  # a tenth of the reference's error
    assert curves["rk4 in float"] == curves["recommended"] == [[(20.0, 1e-4)]]
    assert curves["tolerance 0.001"] == [[(10.0, 1e-3), (1000.0, 1e-3)]]
    assert figure.ax.get_xscale() == figure.ax.get_yscale() == "log"
    assert figure.ax.get_ylabel() == "relative error of drivers.d.mean_force.x"
    assert refused(draw, "t", "--x", "v").message == "not for studies"
    write(tmp_path / "t", tradeoff_json={**tradeoff, "points": []})
    assert refused(draw, "t").code == "plot.no_data"
    write(tmp_path / "t", tradeoff_json={"points": [1]})
    assert refused(draw, "t").code == "file.invalid"


def test_the_curves_of_a_comparison(draw, tmp_path):
    write(tmp_path / "c", curves_csv='model,name,displacement [length],force [force]\n'
          '0,"a, b",0,1\n0,"a, b",2,3\n1,"a, b",0,5\n')
    figure = draw("c")
    assert figure.curves() == [("a, b", [[(0.0, 1.0), (2.0, 3.0)]]), ("a, b", [[(0.0, 5.0)]])]
    assert figure.ax.get_xlabel() == "displacement of the driver [length]"


# Folders of runs.

def test_damaged_tables_are_refused_with_the_place(draw, tmp_path):
    header = "time [time],a [x],b [y]\n"
    for text, code, line, column in (
            (header + "0,1,2\n0,1\n", "file.damaged", 3, 1),
            (header + "0,1,2,3\n", "file.damaged", 2, 1), (header + "0,1.5x,2\n", "file.damaged", 2, 3),
            (header + "0,,2\n", "file.damaged", 2, 3), (header + "0,1,nan\n", "file.damaged", 2, 5),
            (header + "0,1,2\n1,2,3", "file.damaged", 3, 1), (header, "plot.no_data", 0, 0),
            (header + "0,1_0,2\n", "file.damaged", 2, 3),
            ("x [length],y [length]\n", "file.invalid", 1, 1), ("", "file.invalid", 1, 1)):
        run(tmp_path / "run", text)
        fault = refused(draw, "run", "--x", "time", "--y", "a")
        assert (fault.code, fault.line, fault.column) == (code, line, column), text
    (tmp_path / "run" / "observables.csv").write_bytes(b"time [time]\n\xff\n")
    assert refused(draw, "run").code == "file.invalid"
    (tmp_path / "run" / "observables.csv").unlink()
    assert "[output] every" in refused(draw, "run").message
    os.mkfifo(tmp_path / "run" / "observables.csv")
    assert refused(draw, "run").code == "file.cannot_read"  # at once


@pytest.mark.parametrize("text", ["", "{", "[1, 2]", "{}", '{"status": 3}', "[" * 100000, "\xff"])
def test_what_is_no_summary_is_refused(draw, tmp_path, text):
    run(tmp_path / "run", table(TRACES, (0, 0, 0, 0, 0)))
    (tmp_path / "run" / "summary.json").write_bytes(text.encode("latin-1"))
    assert refused(draw, "run").code == "file.invalid"


def test_hostile_summaries(draw, tmp_path):
    """Numbers beyond a double, names that are markup: it is drawn, or refused with a sentence."""
    run(tmp_path / "$a_{b}$", table(TRACES, (0, 0, 0, 0, 0), (1, 1, 1, 4, 3)), scene_toml="no = = toml",
        summary={"parameters": {"v": 10 ** 400, "w": "x", "k": True}, "scene": {"axes": 3},
                 "drivers": {"d": {"mean_force": [1e999, None], "deep": {"a": [[1]]}}}})
    run(tmp_path / "b", table(TRACES, (0, 0, 0, 0, 0), (1, 1, 1, 4, 3)), status="interrupted\n\x1b[1m",
        summary={"scene": {"axes": {"length": r"\frac{", "force": "$", "mass": 3}}})
    assert draw("$a_{b}$").ax.get_ylabel() == "lateral force $F_x$"
    figure = draw("b")
    assert figure.ax.get_xlabel() == r"driver position $vt$ / \frac{"
    assert figure.notes == ["b: the run is not finished but interrupted ?[1m"]
    assert refused(draw, "$a_{b}$", *LAW, "v").key == "--against v"
    shutil.copytree(tmp_path / "$a_{b}$", tmp_path / "c")
    assert draw("$a_{b}$", "c").key() == [r"\$a_{b}\$", "c"]


@pytest.mark.parametrize("low, high", [(-1e308, 1e308), (0.0, 1e-320), (5.0, 5.0), (-6.0, -5.0),
                                       (1e15, 1e15 + 1.0), (1.0, 1.0 + 4e-16)])
def test_numbers_at_the_ends_of_doubles(draw, tmp_path, low, high):
    """Every figure has finite axes, or is refused with a sentence."""
    header = "time [time],d.force.x [force],d.position.x [length],t.centre_of_mass.x [length]," \
        "t.centre_of_mass.y [length]"
    run(tmp_path / "run", table(header, (0, low, low, low, low), (1, high, high, high, high)),
        summary={"parameters": {"v": low}, "drivers": {"d": {"mean_force": [high]}}},
        events_csv=SLIPS + f"1,slip,d,1,{low!r},{low!r},1\n2,slip,d,1,{high!r},{high!r},1\n")
    image = ("raster", "--x", "d.position.x", "--y", "t.centre_of_mass.x", "--value", "d.force.x")
    drawn = 0
    for words in ([], ["path"], ["hysteresis"], ["loop"], ["slips"], image, ["--log", "xy"],
                  [*LAW, "v"]):
        try:
            figure = draw("run", *words)
        except tomlin.SceneError as error:
            assert error.faults[0].message
        else:
            drawn += 1
            assert np.isfinite([*figure.ax.get_xlim(), *figure.ax.get_ylim()]).all()
    assert drawn > 3 or high == 1e308


# The command line.

def test_words_are_folders_or_a_figure(draw, two, tmp_path):
    assert refused(draw, "oen").nearest == "one"
    assert refused(draw, "one", "hysteresys").nearest == "hysteresis"
    assert "force" in refused(draw, "one", "force", "speed").message
    assert refused(draw, "force", "one").code == "file.invalid"  # the first word is a folder
    (tmp_path / "empty").mkdir()
    assert "summary.json" in refused(draw, "empty").message
    shutil.copytree(tmp_path / "one", tmp_path / "position")
    assert draw("position").ax.get_ylabel() == "lateral force $F_x$"
    assert draw("position", "position").ax.get_ylabel() == "centre of mass $x_c$"
    assert draw("one", "position/").key() == ["one", "position"]


@pytest.mark.parametrize("words, key, code", [
    (["--at", "1"], "--at", "command.conflict"), (["ring", "--y", "time"], "--y", "command.conflict"),
    (["--value", "size"], "--value", "command.conflict"),
    (["loop", "--log", "x"], "--log", "command.conflict"),
    (["speed", "--y", "force"], "speed", "command.conflict"),
    (["ring", "--at", "a=1"], "--at", "command.invalid_value"),
    *((["--size", size], "", "command.invalid_value")
      for size in ("400", "x", "400x", "10x300", "400x300x2", "1e9x300")),
    (["--size", "100x100"], "100x100", "command.invalid_value"),
    (["--font", "Times,1000"], "", "command.invalid_value"),
    (["--log", "z"], "", "command.invalid_value"), (["--from", "nan"], "", "command.invalid_value"),
    (["--y", "force,"], "", "command.invalid_value"),
    (["slips", "--bins", "0"], "", "command.invalid_value"),
    (["--titel", "x"], "", "command.unknown_option"), (["--y"], "", "command.missing_argument")])
def test_options_that_do_not_go_together_are_refused(draw, two, words, key, code):
    fault = refused(draw, "one", *words)
    assert (fault.key, fault.code) == (key, code)


def test_the_figure_has_the_size_and_font_asked_for(draw, two):
    figure = draw(*two, "--size", "400x300", "--font", "DejaVu Serif,10", "--title", "a $ b")
    assert np.allclose(figure.canvas.get_size_inches() * 72.0, (400.0, 300.0))
    texts = [*figure.ax.get_xticklabels(), *figure.ax.get_legend().get_texts()]
    assert all(text.get_fontsize() == 10.0 for text in texts)
    assert texts[-1].get_fontname() == "DejaVu Serif"
    assert [text.get_text() for text in figure.canvas.texts] == [r"a \$ b"]
    # Nothing is cut, whatever the length of names.
    for words in ([], ["--size", "900x400"]):
        figure = draw(*two, "--label", "x" * 60, "--label", "two", *words)
        width, height = figure.canvas.get_size_inches() * 72.0
        box = figure.ax.get_legend().get_window_extent(figure.canvas.canvas.get_renderer())
        whole = figure.ax.get_tightbbox(figure.canvas.canvas.get_renderer())
        assert box.x1 <= width and min(whole.x0, whole.y0) >= 0.0 and whole.y1 <= height
        assert whole.x1 <= box.x0


def test_a_key_longer_than_its_panel_is_shown_whole(draw, tmp_path):
    names = []
    for k in range(20):
        run(tmp_path / f"r{k}", table(TRACES, (0, k, 0, 0, 0), (1, 1, 1, 4, 3)))
        names.append(f"r{k}")
    figure = draw(*names, "--y", "force", "--y", "force,driver.force.y")
    renderer = figure.canvas.canvas.get_renderer()
    first, second = (ax.get_legend().get_window_extent(renderer) for ax in figure.axes)
    assert first.y0 > second.y1 and second.y0 > 0.0
    styles = {(line.get_color(), str(line._unscaled_dash_pattern)) for line in figure.ax.lines}
    assert len(styles) == 20  # colours are used up, and dashes go on


@pytest.fixture
def plot(tmp_path):
    """The command as a program."""
    def done(*words, **options):
        return subprocess.run([sys.executable, "-m", "tomlin", "plot", *words], cwd=tmp_path,
                              capture_output=True, text=True, **{"env": ENVIRONMENT, **options})

    return done


def test_every_format_and_the_same_bytes(plot, two, tmp_path):
    (tmp_path / "matplotlibrc").write_text("axes.facecolor: red\nlines.linewidth: 9\n")
    for name, magic in (("a.svg", b"<?xml "), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF-")):
        done = plot("one", "two", "hysteresis", "-o", name)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        first = (tmp_path / name).read_bytes()
        assert first.startswith(magic) and not list(tmp_path.glob("*.part"))
        again = plot("one/", "two", "hysteresis", "-o", name, env={
            "PYTHONPATH": SITE, "LC_ALL": "C", "MPLBACKEND": "nonsense",
            "MATPLOTLIBRC": str(tmp_path / "matplotlibrc")})
        assert again.returncode == 0 and (tmp_path / name).read_bytes() == first, again.stderr
    svg = (tmp_path / "a.svg").read_text()
    assert ">two<" in svg and "<tspan" in svg  # texts are texts


def test_the_program_draws_the_same(program, plot, two, tmp_path):
    def drawn(by, *words):
        return subprocess.run([by, "plot", *words], cwd=tmp_path, capture_output=True, text=True,
                              env={"PATH": "/usr/bin:/bin"})

    if not (BUILD / "python" / "tomlin-plot").exists():
        pytest.skip("the module is not beside the program")
    assert plot("one", "two", "-o", "a.svg").returncode == 0
    done = drawn(program, "one", "two", "-o", "b.svg", "--title", "")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    for words in (["--help"], ["-h"]):
        assert drawn(program, *words).stdout == plot(*words).stdout
    done = drawn(program, "oen", "-o", "c.svg")
    assert done.returncode == 2 and done.stderr == plot("oen", "-o", "c.svg").stderr
    # The program says what to install if there is no module.
    (tmp_path / "bin").mkdir()
    shutil.copy(program, tmp_path / "bin")
    done = drawn(str(tmp_path / "bin" / "tomlin"), "one", "-o", "c.svg")
    assert done.returncode == 2 and "python3-matplotlib" in done.stderr
    assert done.stderr.endswith("[plot.no_matplotlib]\n")
    done = drawn(str(tmp_path / "bin" / "tomlin"), "--help")
    assert (done.returncode, done.stderr) == (0, "") and "tomlin-plot: No such file" in done.stdout


def test_exit_status(plot, two, tmp_path):
    """0, 1 or 2, and a sentence."""
    assert plot("--help").returncode == 0 and "hysteresis" in plot("--help").stdout
    done = plot("one", "-o", "a.gif")
    assert done.returncode == 2 and done.stderr.startswith("-o: error: a.gif: the suffix")
    (tmp_path / "b.svg").mkdir()
    assert plot("one", "-o", "b.svg").returncode == plot("one", "-o", "none/a.svg").returncode == 2
    assert plot().returncode == plot("one").returncode == 2
    without = subprocess.run(
        [sys.executable, "-c", "import sys; sys.modules['matplotlib'] = None\n"
         "from tomlin._plots.command import main; sys.exit(main(['plot', 'one', '-o', 'a.svg']))"],
        cwd=tmp_path, capture_output=True, text=True, env=ENVIRONMENT)
    assert without.returncode == 2 and "python3-matplotlib" in without.stderr
    assert without.stderr.endswith("[plot.no_matplotlib]\n") and not (tmp_path / "a.svg").exists()
    done = subprocess.run([sys.executable, "-m", "tomlin"], capture_output=True, text=True,
                          env=ENVIRONMENT)
    assert done.returncode == 2 and "plot DIR" in done.stderr


def test_a_picture_that_cannot_be_written(draw, two, monkeypatch, tmp_path):
    (tmp_path / "a.svg").write_text("before")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(command.os, "replace", full)
    with pytest.raises(tomlin.OutputError, match="No space left"):
        draw("one")
    assert (tmp_path / "a.svg").read_text() == "before" and not list(tmp_path.glob("*.part"))


# Results in Python.

def test_figures_of_results_and_sweeps_are_those_of_the_command(tip, draw, tmp_path):
    result = tip.set("v", 0.05).run(folder=tmp_path / "tip")
    for what in ("force", "hysteresis", "speed"):
        [line] = result.plot(what).lines
        x, y = zip(*draw("tip", what).curves()[0][1][0])
        assert (np.array(line.get_xdata()) == x).all() and (np.array(line.get_ydata()) == y).all()
    assert tomlin.open(tmp_path / "tip").plot("slips").get_xlabel() == "size of a slip"
    over = {"v": np.geomspace(0.05, 0.2, 3), "s": [0.5, 5.0]}
    sweep_here = tomlin.sweep(tip, over, ["driver.mean_force.x"], folder=tmp_path / "map")
    axes = sweep_here.plot(x="v")
    drawn = draw("map", "--y", "driver.mean_force.x", "--x", "v", "--log", "x")
    assert [line.get_label() for line in axes.lines] == drawn.labels() == ["s = 0.5", "s = 5"]
    for line, (_, [points]) in zip(axes.lines, drawn.curves()):
        assert np.array_equal(np.stack(line.get_data(), axis=1), points)
    assert axes.get_xscale() == drawn.ax.get_xscale() == "log"
    assert draw("map").cells().T.tolist() == sweep_here["driver.mean_force.x"].tolist()
    with pytest.raises(KeyError):
        sweep_here.plot("no.such")
    refined = tomlin.sweep(tip, over, ["driver.mean_force.x"], refine="driver.mean_force.x=0.8",
                           refine_along="v", refine_to=0.02)
    lines = refined.plot().lines
    assert sum(len(line.get_xdata()) for line in lines) == refined.shape[0] > 6
    assert all((np.diff(line.get_xdata()) > 0.0).all() for line in lines)


def test_options_are_those_of_matplotlib(tip):
    axes = tip.run().plot(c="red", ls="--", lw=3.0, label="slow")
    tip.set("v", 0.1).run().plot(ax=axes, label="fast")
    first, second = axes.lines
    assert (first.get_color(), first.get_linestyle(), first.get_linewidth()) == ("red", "--", 3.0)
    assert second.get_color() != "red" and axes.get_ylim()[1] > max(second.get_ydata())
    assert [text.get_text() for text in axes.legend().get_texts()] == ["slow", "fast"]
    assert len({line.get_color() for line in tip.run().plot(ax=axes).lines}) == 3


def test_a_flexible_ring_warns():
    scene = RING.replace('"rigid"', '"particles"').replace("[run]", "[output]\nevery = 0.1\n[run]")
    with pytest.warns(UserWarning, match="ring is flexible"):
        axes = tomlin.parse(scene).run().plot("ring")
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "t = 0", "t = 0.25", "t = 0.5", "t = 0.75", "t = 1", "particle 0", "centre of mass"]


def test_errors_of_sweeps_are_bars(tip):
    axes = tomlin.sweep(tip.set("run.accuracy", 1e-3), {"v": [0.05, 0.1]},
                        ["driver.mean_force.x"]).plot()
    [bars] = [one for one in axes.collections if hasattr(one, "get_segments")]
    lengths = [np.ptp(segment[:, 1]) for segment in bars.get_segments()]
    assert len(lengths) == 2 and min(lengths) > 0.0


def test_no_text_is_markup(tmp_path):
    """Titles and labels are shown as they are."""
    from tomlin._plots.figure import Curve, Figure, Panel

    texts = [r"$\frac{$", "$x$", "a_b^c", r"\$", "\x07 bell\n", "it's \"1\" <i> & `c`", "\udcff", ""]
    for text in texts:
        figure = Figure("x", [Panel("y", 100.0, [Curve(np.arange(2.0), np.arange(2.0), text)],
                                    title=text)], (0.0, 1.0))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            svg = picture(figure, PageFormat(text), "svg").decode()
        assert "</svg>" in svg
    assert ">$x$<" in picture(Figure("x", [Panel("y", 100.0, [Curve(
        np.arange(2.0), np.arange(2.0), "$x$")])], (0.0, 1.0)), PageFormat(), "svg").decode()
