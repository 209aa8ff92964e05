#!/usr/bin/env python3
"""A run leaves the same bits behind, whatever compiled the program, whatever instruction set it
chooses, wherever its memory lies, and whatever the user's language is.

Runs the scenes of scenes.py by each PROGRAM and under each condition and compares every file of the
run's folder byte by byte; of summary.json all but `performance`. The table results.json, beside this
file, holds hashes of what each scene gave when its row was written: numbers of a released version
do not change without an entry in the changelog. A change of the code removes a row with its scene,
writes it anew with --write and says in the changelog why and by how much, or leaves it.

usage: determinism_test.py [--write] PROGRAM...
"""
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from scenes import SCENES

SUMMARY = "summary.json"
INSTRUCTION_SETS = ("baseline", "avx2", "avx512")
LANGUAGE = "de_DE.UTF-8"  # where a decimal point is a comma
TABLE = pathlib.Path(__file__).with_name("results.json")
# Not a result: the version of the program, and sentences whose codes stand beside them.
WITHOUT_HASH = ("program", "warnings")
RUN_SECONDS = 120         # of the slowest scene, not optimised, on a busy machine: some 20


class Condition:
    """How a program is started."""

    def __init__(self, name, prefix=(), environment=None, instruction_set=None):
        self.name = name
        self.prefix = list(prefix)
        self.environment = environment or {}
        self.instruction_set = instruction_set


def works(command, environment=None):
    try:
        return subprocess.run(command, env={**os.environ, **(environment or {})},
                              capture_output=True).returncode == 0
    except OSError:
        return False


def language_condition(folder):
    """A locale with a decimal comma, made for the purpose; or why there is none."""
    locales = folder / "locales"
    locales.mkdir()
    if shutil.which("localedef") is None:
        return None, "there is no localedef"
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", str(locales / LANGUAGE)],
                          capture_output=True, text=True)
    environment = {"LOCPATH": str(locales), "LC_ALL": LANGUAGE, "LANG": LANGUAGE}
    point = subprocess.run(["locale", "decimal_point"], env={**os.environ, **environment},
                           capture_output=True, text=True).stdout.strip()
    if point != ",":
        reason = made.stderr.strip().splitlines() or ["no reason given"]
        return None, f"localedef makes no {LANGUAGE}: {reason[0]}"
    return Condition("decimal comma", environment=environment), None


def conditions(folder):
    """Those of this machine; the reasons for which others are left out are printed."""
    found = [Condition("as it is")]
    found += [Condition(name, environment={"TOMLIN_INSTRUCTION_SET": name}, instruction_set=name)
              for name in INSTRUCTION_SETS]
    if works(["setarch", "-R", "true"]):
        found.append(Condition("fixed addresses", prefix=["setarch", "-R"]))
    else:
        print("left out: fixed addresses: setarch -R does not work here")
    language, reason = language_condition(folder)
    if language:
        found.append(language)
    else:
        print(f"left out: decimal comma: {reason}")
    return found


def run(program, scene, folder, condition, settings=()):
    """Results of one run: bytes by file name, and the instruction set that it took."""
    command = [*condition.prefix, str(program), "run", str(scene), "--quiet", "-o", str(folder)]
    for setting in settings:
        command += ["--set", setting]
    ended = subprocess.run(command, env={**os.environ, **condition.environment}, timeout=RUN_SECONDS,
                           capture_output=True, text=True)
    if ended.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with {ended.returncode}:\n{ended.stderr}")
    files = {str(path.relative_to(folder)): path.read_bytes()
             for path in sorted(folder.rglob("*")) if path.is_file()}
    shutil.rmtree(folder)
    # Numbers as they are written, not as Python would write them.
    summary = json.loads(files[SUMMARY], parse_float=str, parse_int=str)
    performance = summary.pop("performance")
    files[SUMMARY] = json.dumps(summary, indent=1).encode()
    return files, performance["instruction_set"]


def differences(files, others):
    """Names of the files that are not the same in both, with the first line that differs."""
    found = []
    for name in sorted(files.keys() | others.keys()):
        one, other = files.get(name), others.get(name)
        if one == other:
            continue
        if one is None or other is None:
            found.append(f"{name}: only one of the runs has it")
            continue
        lines, other_lines = one.splitlines() + [b"(end)"], other.splitlines() + [b"(end)"]
        at = next(i for i, pair in enumerate(zip(lines, other_lines)) if pair[0] != pair[1])
        found.append(f"{name}:{at + 1}: {lines[at][:200]!r} is {other_lines[at][:200]!r}")
    return found


def row_of(files):
    """The row of the table: hashes of summary, samples and events, and of all else that holds
    results; the effective scene has its own hash in the summary."""
    summary = json.loads(files[SUMMARY], parse_float=str, parse_int=str)
    for key in WITHOUT_HASH:
        summary.pop(key)
    contents = {**files, SUMMARY: json.dumps(summary, sort_keys=True).encode()}
    return {name: hashlib.sha256(text).hexdigest()[:16] for name, text in sorted(contents.items())
            if name != "scene.toml"}


def compare(programs, folder, table):
    """Number of runs compared, and of differences. Rows that are found replace those of the table."""
    known = conditions(folder)
    compared, faults, absent = 0, 0, set()
    for name, text in SCENES.items():
        scene = folder / f"{name}.toml"
        scene.write_text(text)
        expected = None
        for program in programs:
            for condition in known:
                if (program, condition.name) in absent:
                    continue
                files, taken = run(program, scene, folder / "out", condition)
                if condition.instruction_set not in (None, taken):
                    print(f"left out: {program} on {condition.name}: it takes {taken}")
                    absent.add((program, condition.name))
                    continue
                if expected is None:
                    expected = files
                    row = row_of(files)
                    if table.get(name) != row:
                        print(f"{name}: not the bits of {TABLE.name}, but {row}")
                        faults += 1
                    table[name] = row
                    continue
                compared += 1
                for difference in differences(expected, files):
                    print(f"{name}, {program}, {condition.name}: {difference}")
                    faults += 1
    return compared, faults


def check_that_differences_are_seen(program, folder):
    """Number of changes that went unseen."""
    name = "ring_rigid_adaptive"
    scene, plain = folder / "control.toml", Condition("as it is")
    scene.write_text(SCENES[name])
    files, _ = run(program, scene, folder / "out", plain)
    # The last digit of one number.
    others, _ = run(program, scene, folder / "out", plain,
                    ["force.driver.stiffness=2.0000000000000004"])
    seen = {difference.split(":")[0] for difference in differences(files, others)}
    unseen = {SUMMARY, "observables.csv", "scene.toml"} - seen
    for name in sorted(unseen):
        print(f"{name}: a changed last digit is not seen, so the comparison sees nothing")
    fewer = {name: text for name, text in files.items() if name != "observables.csv"}
    if row_of(files) == row_of(others) or row_of(files) == row_of(fewer):
        print("a changed last digit, or a missing file, does not change the row of the table")
        unseen.add("row")
    if not differences(files, fewer) or differences(files, dict(files)):
        print("a missing file is not seen, or equal ones are")
        unseen.add("missing")
    return len(unseen)


def main():
    writes = sys.argv[1:2] == ["--write"]
    programs = [pathlib.Path(name).resolve() for name in sys.argv[1 + writes:]]
    if not programs:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        table = json.loads(TABLE.read_text()) if TABLE.exists() else {}
        stale = sorted(table.keys() - SCENES.keys())
        for name in stale:
            print(f"{name}: a row of {TABLE.name} without a scene")
            del table[name]
        compared, faults = compare(programs, folder, table)
        faults += len(stale)
        if writes:
            TABLE.write_text(json.dumps(table, indent=1) + "\n")
        faults += check_that_differences_are_seen(programs[0], folder)
    print(f"{compared} runs of {len(SCENES)} scenes compared, {faults} differences")
    sys.exit(1 if faults or compared < len(SCENES) else 0)


if __name__ == "__main__":
    main()
