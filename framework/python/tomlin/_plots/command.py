"""`tomlin plot`: figures of folders that runs, sweeps and studies have left."""

from __future__ import annotations

import argparse
import logging
import math
import os
import re
import sys
import tempfile
import warnings
from collections.abc import Iterable, Sequence
from typing import Any, NoReturn

from tomlin._errors import Error, OutputError, SceneError, nearest_name, refusal
from tomlin._plots.bodies import ring_figure, surface_figure
from tomlin._plots.draw import PageFormat, picture
from tomlin._plots.figure import Figure
from tomlin._plots.images import MOST_PIXELS, SCANS, RasterRequest, raster_figure
from tomlin._plots.quantities import KINDS, QUANTITIES, Owners, owners_of
from tomlin._plots.results import result_figure
from tomlin._plots.runs import Run, curve_labels, in_order_of_parameters, read_json, read_run
from tomlin._plots.slips import MOST_BINS, SLIP_MEASURES, slips_figure
from tomlin._plots.studies import read_comparison, tradeoff_figure
from tomlin._plots.sweeps import SweepRequest, holds_sweep, read_sweep, sweep_figure
from tomlin._tables import number_in, one_line
from tomlin._plots.traces import CurvesRequest, curves_figure, loop_figure

DONE, FAILED, BAD_INPUT = 0, 1, 2

#: Figures that are not one quantity over another: the options that they take, and a summary.
_SPECIAL = {
    "loop": ("--driver --label",
             "friction loop of a driver that reverses: force over support position"),
    "ring": ("--x --at --driver --body --label",
             "particles of a ring, or another planar body, at the moments --at"),
    "surface": ("--body --from --to", "the path of a body over the potential of its substrates"),
    "raster": ("--x --y --value --scan --pixels --driver --body",
               "--value in colours over --x and --y: an image of scan lines"),
    "slips": ("--value --bins --log --driver --label", "histogram of slips by --value"),
}
_OPTIONS = {
    "curves": "--x --y --from --to --log --driver --body --label",
    "results": "--result --against --log",
    "sweeps": "--x --y --value --minimum-along --at --result --against --log",
    "studies": "",
}
_MORE = " (tomlin plot --help tells more)"
_FORMATS = ("svg", "png", "pdf")
_MOST_NEIGHBOURS = 1000  # folders that are searched for a nearest name

_FOOTER = """
The first word is a folder; another folder that is called like a figure is written with a slash, ring/.
X and Y are such a quantity or any column of observables.csv. Commas put curves on one axis, another
--y makes another panel below. Several DIRs are curves of one figure, named by the parameters in
which their scenes differ, and in the order of their values, or else by their folders; --label names
them otherwise, in the order given. With --result and --against each DIR is a point, with its error
where the run states one; runs that differ in a second parameter are on curves of their own.

The folder of a sweep is drawn alone and without WHAT. Over one axis it is a curve of the first
observable; --y names others, and panels, as above. Over two axes it is a map with a cell around each
point and the first axis along x: --x and --y name other axes, --value another observable, and
--minimum-along an axis: a line joins the points of least value along it, one for each value of the
other axis. With an observable as --y, or --result and --against, it is curves over one axis, one for
each value of the others, with error bars where the sweep has errors. --at NAME=VALUE shows one value
of an axis alone. Axes are logarithmic where the grids of their values are, unless --log is given.
Where points have no number, cells stay white and curves break. Folders of tomlin tradeoff and tomlin
compare are drawn alone, too: error against cost, and forces over the displacement.

A raster has the mean of all samples in each pixel: a row for each value of Y, or for each stroke
along X, and two samples to a pixel on average, unless --pixels says otherwise. Pixels without a
sample stay white. A potential is that of one particle on the periodic forces of scene.toml.

An axis has a unit where the scene names it, [scene] axes = { length = "a" }, and in metal units.

Examples:

  tomlin plot pt.out -o force.svg
      the friction trace.
  tomlin plot k_2.out k_8.out hysteresis -o loops.pdf
      two runs on the same axes.
  tomlin plot ring.out --y force_size --y position --y height --from 2 --to 4 -o steps.svg
      three panels versus v t from 2 to 4.
  tomlin plot v_1.out v_2.out ring --x driver_position --at 2,2.5,3 -o rings.svg
      two rings, when their drivers have come so far.
  tomlin plot v_1.out v_2.out v_3.out --result driver.mean_force.x --against v --log x -o law.svg
      the mean force over the velocity.
  tomlin plot line_1.out line_2.out raster --x driver.position.x --y driver.position.y \\
      --value driver.force.x --scan forward -o image.png
      an image of the lateral force, from one run for each scan line.
  tomlin plot map --x v --y lambda --value driver.mean_force.x --minimum-along lambda -o map.svg
      a sweep over two axes as a map, and for each v where along lambda the mean force is least.

matplotlib draws (Debian: python3-matplotlib). An earlier FILE is replaced. The same runs give the
same picture.

Exit status: 0 done; 1 FILE could not be written; 2 invalid input, or there is no
matplotlib."""

# Options, what their values are, and help; those of `_SEVERAL` may be given again.
_HELP = (
    ("--x", "X", "a quantity or a column, instead of WHAT's"),
    ("--y", "Y[,Y]", "the same upwards; again for another panel"),
    ("--from", "X", "where the x axis begins"),
    ("--to", "X", "where it ends"),
    ("--at", "T[,T]", "moments to show a ring at: times, or values of --x; five by default; of a "
     "sweep NAME=VALUE, the value of an axis that is shown"),
    ("--driver", "NAME", "which one, where there are several"),
    ("--body", "NAME", "likewise"),
    ("--label", "TEXT", "what to call a DIR; once for each, in order"),
    ("--value", "VALUE", "what a raster or the map of a sweep shows; of slips size (by default), "
     "peak_force or energy"),
    ("--minimum-along", "NAME", "a line on the map of a sweep: where VALUE is least along this axis"),
    ("--scan", "WAY", "the samples of a raster at which X rises, or falls: forward, backward; both "
     "by default"),
    ("--pixels", "WIDTHxHEIGHT", "of a raster; by its samples unless given"),
    ("--bins", "N", "of a histogram; by the number of slips unless given"),
    ("--result", "RESULT", "a result, as in driver.mean_force.x: a point for each DIR"),
    ("--against", "NAME", "the parameter or result that it is drawn over"),
    ("--log", "AXES", "logarithmic axes: x, y, xy or none; of a sweep as its grids are spaced"),
    ("--size", "WIDTHxHEIGHT", "of the whole figure in points; a PNG has two pixels to a point"),
    ("--font", "NAME,SIZE", "of all texts; sans-serif,12 by default"),
    ("--title", "TEXT", "above the figure; none by default"),
)
_SEVERAL = ("--y", "--at", "--label")
_OF_EVERY_FIGURE = ("--size", "--font", "--title")


def _epilog() -> str:
    def lines(rows: Iterable[tuple[str, str]]) -> list[str]:
        return ["", *(f"  {name:<17} {summary}" for name, summary in rows), ""]

    whats = [(name, kind[2]) for name, kind in KINDS.items()]
    whats += [(name, special[1]) for name, special in _SPECIAL.items()]
    return "\n".join(["WHAT:", *lines(whats), "Quantities for --x and --y:",
                      *lines((name, one.summary) for name, one in QUANTITIES.items())]) + _FOOTER


class _Formatter(argparse.RawDescriptionHelpFormatter):
    """Help with the heading that the program has."""

    def add_usage(self, usage: str | None, actions: Iterable[argparse.Action],
                  groups: Iterable[Any], prefix: str | None = None) -> None:
        super().add_usage(usage, actions, groups, prefix or "Usage: ")


class _Parser(argparse.ArgumentParser):
    """Faults of the command line are those of the program."""

    def error(self, message: str) -> NoReturn:
        unknown = re.match(r"unrecognized arguments: (-\S*)", message)
        if unknown:
            name = unknown[1].partition("=")[0]
            raise refusal("command.unknown_option", "tomlin", f"tomlin plot has no option {name}",
                          admissible="tomlin plot --help shows them",
                          nearest=nearest_name(name, [one for one, *_ in _HELP]))
        missing = "required" in message or "expected" in message
        raise refusal("command.missing_argument" if missing else "command.invalid_value", "tomlin",
                      f"{message}{_MORE}")


def _parser() -> _Parser:
    parser = _Parser("tomlin plot", allow_abbrev=False, epilog=_epilog(),
                     description="draw a figure of finished runs, of a sweep or of a study",
                     formatter_class=_Formatter)
    parser.add_argument("words", nargs="*", metavar="DIR", help="folders of runs, and WHAT to draw, "
                        "force by default; or of one sweep or study")
    parser.add_argument("-o", "--output", dest="file", metavar="FILE", required=True,
                        help="the picture: .svg, .png or .pdf")
    for option, metavar, text in _HELP:
        parser.add_argument(option, metavar=metavar, help=text, default=None,
                            action="append" if option in _SEVERAL else "store")
    return parser


def _refuse_value(option: str, why: str, admissible: str = "") -> NoReturn:
    raise refusal("command.invalid_value", "tomlin", f"{option}: {why}", admissible=admissible)


def _parts(text: str, option: str) -> list[str]:
    parts = text.split(",")
    if "" in parts:
        _refuse_value(option, f'"{one_line(text)}" has an empty part')
    return parts


def _number(text: str, option: str) -> float:
    number = number_in(text)
    if not math.isfinite(number):
        _refuse_value(option, f'"{one_line(text)}" is not a number')
    return number


def _two_numbers(text: str, option: str, least: float, most: float) -> tuple[float, float]:
    first, cross, second = text.partition("x")
    if not cross:
        _refuse_value(option, f'"{one_line(text)}" is not WIDTHxHEIGHT')
    numbers = _number(first, option), _number(second, option)
    for number in numbers:
        if not least <= number <= most:
            _refuse_value(option, f"{number:g} is out of range", f"{least:g} to {most:g}")
    return numbers


class _Arguments:
    """The options, checked and taken apart."""

    def __init__(self, given: argparse.Namespace):
        text = {option: getattr(given, option[2:].replace("-", "_")) for option, *_ in _HELP}
        self.words: list[str] = given.words
        self.file: str = given.file
        if not self.words:
            raise refusal("command.missing_argument", "tomlin", f"DIR is required{_MORE}")
        self.given = {option for option, value in text.items() if value}
        self.x, self.value, self.scan = (text[one] or "" for one in ("--x", "--value", "--scan"))
        self.result, self.against = text["--result"] or "", text["--against"] or ""
        self.minimum_along = text["--minimum-along"] or ""
        self.owners = Owners(text["--driver"] or "", text["--body"] or "")
        self.labels: list[str] = text["--label"] or []
        self.y = [_parts(panel, "--y") for panel in text["--y"] or []]
        self.start = _number(text["--from"], "--from") if text["--from"] else None
        self.end = _number(text["--to"], "--to") if text["--to"] else None
        moments = [one for list_ in text["--at"] or [] for one in _parts(list_, "--at")]
        self.at = [_number(one, "--at") for one in moments if "=" not in one]
        self.fixed = [(one.partition("=")[0], one.partition("=")[2]) for one in moments
                      if "=" in one]
        if self.scan and self.scan not in SCANS:
            _refuse_value("--scan", f'"{one_line(self.scan)}"', "forward, backward or both")
        self.pixels = None
        if text["--pixels"]:
            columns, rows = _two_numbers(text["--pixels"], "--pixels", 1.0, MOST_PIXELS)
            self.pixels = int(columns), int(rows)
        self.bins = None
        if text["--bins"]:
            bins = _number(text["--bins"], "--bins")
            if not 1 <= bins <= MOST_BINS or bins != int(bins):
                _refuse_value("--bins", f"{bins:g} is out of range", f"1 to {MOST_BINS}")
            self.bins = int(bins)
        self.log: str | None = text["--log"]
        if self.log not in (None, "x", "y", "xy", "none"):
            _refuse_value("--log", f'"{one_line(self.log or "")}"', "x, y, xy or none")
        self.log_x, self.log_y = "x" in (self.log or ""), "y" in (self.log or "")
        self.form = _format(text)

    def check(self, what: str, of: str = "") -> None:
        """Refuses options that the figure has no use for."""
        results = bool(self.result or self.against)
        name = of or (what if what in _SPECIAL else "results" if results else "curves")
        options = _SPECIAL[name][0] if name in _SPECIAL else _OPTIONS[name]
        for option, *_ in _HELP:
            if option in self.given.difference(options.split(), _OF_EVERY_FIGURE):
                raise _conflict(option, f"not for {name}", options)
        if self.at if of == "sweeps" else self.fixed:
            why, admissible = (("a sweep has axes, and no moments", "NAME=VALUE") if of else
                               ("only a sweep has axes", "moments, which are numbers"))
            raise refusal("command.invalid_value", "tomlin", why, key="--at", admissible=admissible)
        if what in KINDS and (results or self.y):
            raise _conflict(what, "this says what to draw, and so does "
                            f"{'--result' if results else '--y'}", "one of them")
        if self.start is not None and self.end is not None and not self.start < self.end:
            raise refusal("command.invalid_value", "tomlin",
                          f"{self.start:g} is not below --to {self.end:g}", key="--from")


def _conflict(key: str, why: str, admissible: str) -> SceneError:
    return refusal("command.conflict", "tomlin", why, key=one_line(key), admissible=admissible)


def _format(text: dict[str, Any]) -> PageFormat:
    form = PageFormat(text["--title"] or "")
    if text["--size"]:
        form.size = _two_numbers(text["--size"], "--size", 50.0, 5000.0)
    if font := text["--font"]:
        name, comma, size = font.rpartition(",")
        form.font = (name if comma else font) or form.font
        form.font_size = _number(size, "--font") if comma else form.font_size
        if not 4.0 <= form.font_size <= 72.0:
            _refuse_value("--font", f'"{one_line(font)}"',
                          "NAME,SIZE with a size of 4 to 72 points")
    return form


def _holds_run(folder: str) -> bool:
    return os.path.isfile(os.path.join(folder, "summary.json"))


def _neighbours(word: str) -> list[str]:
    """Folders of runs and sweeps beside the one that is not there, in the same spelling."""
    above = os.path.dirname(word)
    try:
        with os.scandir(above or ".") as entries:
            names = [entry.name for _, entry in zip(range(_MOST_NEIGHBOURS), entries)]
    except OSError:
        return []
    folders = [os.path.join(above, name) for name in names]
    return [one for one in folders if _holds_run(one) or holds_sweep(one)]


def _refuse_word(word: str) -> NoReturn:
    if os.path.isdir(word):
        raise refusal("file.invalid", one_line(word), "there is no summary.json in it: it is not the "
                      "folder of a run that has ended")
    whats = [*KINDS, *_SPECIAL]
    raise refusal("file.invalid", "tomlin", "neither the folder of a run nor a figure",
                  key=one_line(word), admissible=f"folders that tomlin run has left, and one of "
                  f"{', '.join(whats)}; or one that tomlin sweep has left",
                  nearest=nearest_name(word, [*whats, *_neighbours(word)]))


def _sorted_words(words: Sequence[str]) -> tuple[list[str], str]:
    """Folders and WHAT: the first word is a folder, and a later one that names a figure is WHAT,
    whatever folders there are."""
    folders, what = list[str](), ""
    for word in words:
        if folders and (word in KINDS or word in _SPECIAL):
            if what:
                raise _conflict(word, f"only one figure can be drawn, and {what} is requested already",
                                "one of them")
            what = word
        elif _holds_run(word):
            folders.append(word)
        else:
            _refuse_word(word)
    return folders, what


def _read_runs(folders: Sequence[str], with_samples: bool, notes: list[str]) -> list[Run]:
    runs = []
    for folder in folders:
        run = read_run(folder)
        if with_samples and not os.path.exists(run.file("observables.csv")):
            raise refusal("plot.no_data", folder, "there is no observables.csv: a run leaves one "
                          "when its scene has [output] every")
        if run.status != "finished":
            notes.append(f"{folder}: the run is not finished but {one_line(run.status)}")
        runs.append(run)
    return runs


def _labels(runs: Sequence[Run], arguments: _Arguments) -> list[str]:
    if not arguments.labels:
        return curve_labels(runs)
    if len(arguments.labels) != len(runs):
        raise refusal("command.invalid_value", "tomlin",
                      f"{len(arguments.labels)} for {len(runs)} folders", key="--label",
                      admissible="one for each")
    return arguments.labels


def _require(given: Any, option: str, what: str) -> None:
    if not given:
        raise refusal("command.missing_argument", "tomlin", f"missing for {what}", key=option)


def _curves(runs: Sequence[Run], what: str, arguments: _Arguments, notes: list[str]) -> Figure:
    y, x, _ = KINDS[what or "force"]
    # A force that is a driver has no support.
    if x == "driver_position" and any(not owners_of(run.samples, "position.x") for run in runs):
        x = "time"
    request = CurvesRequest(arguments.x or x, arguments.y or [[y]], arguments.owners,
                            arguments.start, arguments.end, arguments.log_x, arguments.log_y,
                            what == "path" and not arguments.log)
    return curves_figure(runs, _labels(runs, arguments), request, notes)


def _raster(runs: Sequence[Run], arguments: _Arguments, notes: list[str]) -> Figure:
    _require(arguments.x, "--x", "raster")
    _require(arguments.y, "--y", "raster")
    _require(arguments.value, "--value", "raster")
    if len(arguments.y) > 1 or len(arguments.y[0]) > 1:
        raise _conflict("--y", "a raster has one column upwards", "one --y of one column")
    request = RasterRequest(arguments.x, arguments.y[0][0], arguments.value, arguments.owners,
                            arguments.scan or "both", arguments.pixels)
    return raster_figure(runs, request, notes)


def _slips(runs: Sequence[Run], arguments: _Arguments, notes: list[str]) -> Figure:
    measure = arguments.value or "size"
    if measure not in SLIP_MEASURES:
        raise refusal("command.invalid_value", "tomlin", "slips have no such number",
                      key=f"--value {one_line(measure)}", admissible=", ".join(SLIP_MEASURES))
    return slips_figure(runs, _labels(runs, arguments), measure, arguments.owners.driver,
                        arguments.bins, arguments.log_x, arguments.log_y, notes)


def _of_runs(arguments: _Arguments, notes: list[str]) -> Figure:
    folders, what = _sorted_words(arguments.words)
    arguments.check(what)
    results = bool(arguments.result or arguments.against)
    runs = _read_runs(folders, what != "slips" and not results, notes)
    if not arguments.labels:
        runs = in_order_of_parameters(runs)
    if what == "ring":
        return ring_figure(runs, _labels(runs, arguments), arguments.x or "time", arguments.at,
                           arguments.owners, notes)
    if what == "loop":
        return loop_figure(runs, _labels(runs, arguments), arguments.owners)
    if what == "surface":
        if len(runs) > 1:
            raise _conflict(what, "each folder has a potential of its own", "one folder")
        return surface_figure(runs[0], arguments.owners, arguments.start, arguments.end)
    if what == "raster":
        return _raster(runs, arguments, notes)
    if what == "slips":
        return _slips(runs, arguments, notes)
    if results:
        _require(arguments.result, "--result", "--against")
        _require(arguments.against, "--against", "--result")
        return result_figure(runs, arguments.result, arguments.against, arguments.log_x,
                             arguments.log_y, notes)
    return _curves(runs, what, arguments, notes)


def _alone(arguments: _Arguments, what: str) -> None:
    if len(arguments.words) > 1:
        raise _conflict(arguments.words[1], f"{what} is drawn alone, and its contents say what its "
                        "figure is", "one folder")


def _of_sweep(arguments: _Arguments, notes: list[str]) -> Figure:
    _alone(arguments, "a sweep")
    arguments.check("", "sweeps")
    if arguments.against:
        _require(arguments.result, "--result", "--against")
    for option, given, other in (("--y", arguments.y, arguments.result),
                                 ("--x", arguments.x, arguments.against)):
        if given and other:
            raise _conflict(option, f"{other} is given as well", "without --result and --against")
    request = SweepRequest(arguments.against or arguments.x,
                           [[arguments.result]] if arguments.result else arguments.y,
                           arguments.value, arguments.minimum_along, arguments.fixed, arguments.log)
    return sweep_figure(read_sweep(arguments.words[0]), request, notes)


def _of_study(arguments: _Arguments, name: str) -> Figure:
    _alone(arguments, "a study")
    arguments.check("", "studies")
    file = os.path.join(arguments.words[0], name)
    try:
        return read_comparison(file) if name == "curves.csv" else tradeoff_figure(read_json(file))
    except (LookupError, TypeError, ArithmeticError):
        raise refusal("file.invalid", file, "this is not what tomlin tradeoff has left") from None


def _figure(arguments: _Arguments, notes: list[str]) -> Figure:
    first = arguments.words[0]
    if not _holds_run(first):
        if holds_sweep(first):
            return _of_sweep(arguments, notes)
        for name in ("tradeoff.json", "curves.csv"):
            if os.path.isfile(os.path.join(first, name)):
                return _of_study(arguments, name)
    return _of_runs(arguments, notes)


def _suffix(file: str) -> str:
    suffix = os.path.splitext(file)[1][1:]
    if suffix not in _FORMATS:
        raise refusal("command.invalid_value", "-o", "the suffix does not say what kind of picture",
                      key=one_line(file), admissible=".svg, .png, .pdf")
    return suffix


def _check_writable(file: str) -> None:
    """Raises SceneError before anything is read."""
    folder = os.path.dirname(file) or "."
    if os.path.isdir(file):
        raise refusal("file.invalid", "-o", "this is a folder", key=one_line(file),
                      admissible="a file")
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK | os.X_OK):
        why = "cannot be written to" if os.path.isdir(folder) else "is no folder"
        raise refusal("file.cannot_write", "-o", f"{one_line(folder)} {why}", key=one_line(file),
                      admissible="a file in a folder that is there and may be written to")


def _write(file: str, content: bytes) -> None:
    """A picture that is there is replaced by a whole one or not at all."""
    part = ""
    try:
        handle, part = tempfile.mkstemp(dir=os.path.dirname(file) or ".", suffix=".part")
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(part, 0o666 & ~umask)
        os.replace(part, file)
    except OSError as error:
        if part and os.path.exists(part):
            os.unlink(part)
        raise OutputError(f"cannot write {one_line(file)}: {error.strerror}") from None


def _joined(words: Sequence[str]) -> list[str]:
    """Numbers below zero are no options: they are joined to the option before them."""
    joined: list[str] = []
    for word in words:
        if re.match(r"-[\d.]", word) and joined and joined[-1].startswith("--") and (
                "=" not in joined[-1]):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def plot(words: Sequence[str]) -> list[str]:
    """Draws what the words of a command line ask for, and returns notes about it. Raises SceneError,
    OutputError, and ImportError without matplotlib."""
    arguments = _Arguments(_parser().parse_intermixed_args(_joined(words)))
    suffix = _suffix(arguments.file)
    _check_writable(arguments.file)
    notes: list[str] = []
    figure = _figure(arguments, notes)
    _write(arguments.file, picture(figure, arguments.form, suffix))
    return notes


def _say(text: str) -> None:
    """Bytes of names that are no text are escaped."""
    sys.stderr.buffer.write((text + "\n").encode("utf-8", "backslashreplace"))


def _same_for_everybody() -> None:
    """The settings of a user do not change figures, and what matplotlib says about fonts is nothing
    that a user could mend."""
    os.environ.pop("MPLBACKEND", None)
    os.environ["MATPLOTLIBRC"] = os.devnull
    warnings.simplefilter("ignore")
    logging.getLogger("matplotlib").setLevel(logging.ERROR)


def main(words: Sequence[str]) -> int:
    """`python3 -m tomlin`; returns the exit status."""
    if not words or words[0] != "plot":
        _say("usage: python3 -m tomlin plot DIR... [WHAT] -o FILE; everything else is done by the "
             "program tomlin, and by the functions of the module")
        return BAD_INPUT
    _same_for_everybody()
    try:
        for note in plot(words[1:]):
            _say(f"note: {note}")
    except SceneError as error:
        _say(str(error))
        return BAD_INPUT
    except ImportError as error:
        _say(f"tomlin: error: {error} [plot.no_matplotlib]")
        return BAD_INPUT
    except MemoryError:
        _say("tomlin: error: this takes more memory than there is [scene.too_large]")
        return BAD_INPUT
    except Error as error:
        _say(f"tomlin: error: {error} [file.cannot_write]")
        return FAILED
    return DONE
