#!/usr/bin/env python3
"""The paper's Fig. 11 from a run of pull.toml: tube and sheet along the axis, and from above.

    python3 scenarios/nanotube/picture.py DIR OUTPUT.svg [TIME...]

DIR is a run folder with trajectory.xyz ([output] trajectory = true, trajectory_format = "xyz"). One atom of the tube is
marked. Times are in ps, the first and the last frame by default.

Exit status: 0 written, 1 no such run or time, 2 bad arguments.
"""

import pathlib
import re
import sys

SCALE = 9.0  # points per Angstrom
MARGIN = 12.0
TUBE, SHEET, MARKED = "#1f77b4", "#8c6d46", "#d62728"
MARKED_ATOM = 0


class NoPicture(Exception):
    pass


def frames(path):
    """Yields (time, lines of atoms) for each frame of an extended XYZ file."""
    with open(path, encoding="utf-8") as file:
        for count in file:
            facts = next(file)
            time = float(re.search(r"\btime=(\S+)", facts, re.IGNORECASE).group(1).strip('"'))
            columns = re.search(r"Properties=(\S+)", facts).group(1).split(":")
            yield time, columns, [next(file).split() for _ in range(int(count))]


def column_of(columns, name):
    """Where a property begins among the columns."""
    at = 0
    for key, _, width in zip(columns[::3], columns[1::3], columns[2::3]):
        if key == name:
            return at
        at += int(width)
    raise NoPicture(f"the trajectory has no property {name}")


def chosen(path, times):
    all_frames = list(frames(path))
    if not times:
        return [all_frames[0], all_frames[-1]]
    found = []
    for time in times:
        near = min(all_frames, key=lambda frame: abs(frame[0] - time))
        if abs(near[0] - time) > 0.5 * abs(all_frames[1][0] - all_frames[0][0]) + 1e-9:
            raise NoPicture(f"there is no frame at {time:g} ps")
        found.append(near)
    return found


def dots(places, color, size):
    """Dots of one colour, as one path of strokes without length."""
    way = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in places)
    return (f'<path d="{way}" fill="none" stroke="{color}" stroke-width="{size}" '
            f'stroke-linecap="round"/>')


def panel(atoms, axes, left, top, low, high):
    """Atoms of the sheet, then those of the tube, which covers them from above, then the marked."""
    across, up = axes
    lines = []
    for kind, (color, size) in enumerate(((SHEET, 3.2), (TUBE, 4.8), (MARKED, 9.0))):
        places = [(left + (place[across] - low[across]) * SCALE, top + (high[up] - place[up]) * SCALE)
                  for this, place in atoms if this == kind]
        lines.append(dots(places, color, size))
    return lines


def draw(path, times):
    lines = []
    left = MARGIN
    height = 0.0
    for time, columns, rows in chosen(path, times):
        where = column_of(columns, "pos")
        body = column_of(columns, "body")
        bodies = [row[body] for row in rows]
        atoms = []
        for k, row in enumerate(rows):
            place = [float(x) for x in row[where:where + 3]]
            of_tube = row[body] == bodies[0]
            atoms.append(((2 if k == MARKED_ATOM else 1) if of_tube else 0, place))
        low = [min(atom[1][d] for atom in atoms) for d in range(3)]
        high = [max(atom[1][d] for atom in atoms) for d in range(3)]
        width = (high[1] - low[1]) * SCALE
        front = (high[2] - low[2]) * SCALE
        above = (high[0] - low[0]) * SCALE
        lines.append(f'<text x="{left:.1f}" y="{MARGIN + 4:.1f}">{time:g} ps</text>')
        lines += panel(atoms, (1, 2), left, MARGIN + 12.0, low, high)
        lines += panel(atoms, (1, 0), left, MARGIN + 24.0 + front, low, high)
        left += width + 2.0 * MARGIN
        height = max(height, 2.0 * MARGIN + 24.0 + front + above)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{left:.0f}" height="{height:.0f}" '
            f'font-family="sans-serif" font-size="12">\n' + "\n".join(lines) + "\n</svg>\n")


def main(arguments):
    if len(arguments) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        times = [float(time) for time in arguments[2:]]
    except ValueError as error:
        print(f"picture.py: {error}", file=sys.stderr)
        return 2
    try:
        picture = draw(pathlib.Path(arguments[0]) / "trajectory.xyz", times)
    except (OSError, NoPicture) as error:
        print(f"picture.py: {error}", file=sys.stderr)
        return 1
    pathlib.Path(arguments[1]).write_text(picture, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
