#!/usr/bin/env python3
"""Mutates the shipped scenes, runs what the program accepts, kills the run at random moments, resumes
it and compares every bit with a run that was left alone.

A mutated scene is refused (status 2, and no folder is made), fails with a cause (status 1) or is run
(status 0). Never does the program crash, hang, or write to a terminal what controls one; and a run
that is killed and resumed ends as one that was left alone.

usage: soak_test.py PROJECT PROGRAM [SECONDS [SEED]]

Not run in CI. An hour:
    ctest --preset release-all -L soak                        ten minutes, or TOMLIN_SOAK_SECONDS
    python3 tests/soak/soak_test.py . build/bin/tomlin 3600
What is found stays in the folder soak-found/: the scene, and what differs. A case is told by its
seed; SECONDS = 0 runs that one case alone:
    python3 tests/soak/soak_test.py . build/bin/tomlin 0 1234
"""
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

DEFAULT_SECONDS = 600
RUN_SECONDS = 6        # a mutated scene may take hours: it is stopped, and goes on for as long
END_SECONDS = 60       # a run that was told to stop has to
LARGEST_FILE = 1 << 28
MOST_MEMORY = 1 << 32
KILLS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP,
         signal.SIGUSR1, signal.SIGXCPU)
ODD_NUMBERS = ("0", "0.0", "-1", "1e308", "-1e308", "1e-308", "5e-324", "inf", "nan", "1e17", "3",
               "2147483648", '"1/0"', '"sqrt(-1)"', "[]", '""', "true")
INTEGRATORS = (
    '{ type = "rk4", dt = %g }', '{ type = "velocity_verlet", dt = %g }',
    '{ type = "exponential_verlet", dt = %g }', '{ type = "blanes_moan", dt = %g }',
    '{ type = "midpoint", dt = %g }', '{ type = "dopri5" }', '{ type = "dop853" }',
    '{ type = "radau9" }', '{ type = "euler", dt = %g }')
SETTINGS = ("run.ledger=true", "run.ledger=false", "output.trajectory=true", "run.seed=7",
            'run.number_type="quadruple"', 'run.dynamics="overdamped"', 'run.dynamics="quasistatic"',
            "run.allow_unstable=true", "run.accuracy=1e-3",
            "run.perturb={ size = 1e-9, repeats = 2 }", "output.every=0.37",
            "measure.from=0", 'output.trajectory_format="xyz"')
NUMBER = re.compile(r"(?<![\w.\"])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.\"])")
ACTS_ON_A_TERMINAL = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]")


class Found(Exception):
    """Something that must not be."""


def mutated(text, others, rng):
    """The scene with a few of its numbers, lines or settings changed."""
    for _ in range(rng.randint(0, 4)):
        kind = rng.random()
        lines = text.split("\n")
        at = rng.randrange(len(lines))
        if kind < 0.6:
            numbers = list(NUMBER.finditer(text))
            if not numbers:
                continue
            chosen = rng.choice(numbers)
            if rng.random() < 0.15:
                new = rng.choice(ODD_NUMBERS)
            else:
                try:
                    new = repr(float(chosen.group()) * 10 ** rng.gauss(0, 0.5))
                except ValueError:
                    continue
            text = text[:chosen.start()] + new + text[chosen.end():]
        elif kind < 0.75:
            text = "\n".join(lines[:at] + lines[at + 1:])
        elif kind < 0.85:
            text = "\n".join(lines[:at] + [lines[at]] + lines[at:])
        else:
            text = "\n".join(lines[:at] + [rng.choice(rng.choice(others).split("\n"))] + lines[at:])
    return text


def settings_of(rng):
    chosen = ["run.checkpoint_every=0.01"]
    if rng.random() < 0.9:
        chosen.append("run.duration=%g" % (10 ** rng.uniform(0, 3.5)))
    if rng.random() < 0.4:
        line = rng.choice(INTEGRATORS)
        chosen.append("run.integrator=" +
                      (line % (10 ** rng.uniform(-4, -1)) if "%g" in line else line))
    chosen += rng.sample(SETTINGS, rng.choice((0, 0, 1, 1, 2, 3)))
    words = []
    for setting in chosen:
        words += ["--set", setting]
    return words


def limit():
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(program, folder, words, seconds=None, kill=signal.SIGTERM):
    """Status (negative: killed by that signal) and messages; with `seconds` it is killed then."""
    with open(folder / "messages", "wb") as messages:
        child = subprocess.Popen([str(program), "run", *words, "--quiet"], cwd=folder,
                                 stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                 stderr=messages, preexec_fn=limit)
        try:
            child.wait(seconds)
        except subprocess.TimeoutExpired:
            child.send_signal(kill)
            try:
                child.wait(END_SECONDS)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
                raise Found("it did not stop within %d s of signal %d" % (END_SECONDS, kill))
    said = (folder / "messages").read_bytes()
    if ACTS_ON_A_TERMINAL.search(said):
        raise Found("its messages control a terminal: %r" % said)
    return child.returncode, said


def bits_of(folder):
    files = {}
    for file in folder.iterdir():
        content = file.read_bytes()
        if file.name == "summary.json":
            summary = json.loads(content)
            summary.pop("performance", None)
            content = json.dumps(summary)
        files[file.name] = content
    return files


def differing(one, other):
    a, b = bits_of(one), bits_of(other)
    return [name for name in sorted(a.keys() | b.keys()) if a.get(name) != b.get(name)]


def stopped_by(status):
    """The signal that has ended a run, whether it was caught or not; 0 when none has."""
    if status < 0:
        return -status
    return status - 128 if status > 128 else 0


def go_through(program, folder, words, rng):
    """Refused, failed, too long or compared: what became of the scene."""
    begun = time.monotonic()
    status, said = run(program, folder, words + ["-o", "alone"], RUN_SECONDS)
    taken = time.monotonic() - begun
    if status == 2:
        if (folder / "alone").exists():
            raise Found("refused, but a folder was made: %r" % said)
        return "refused"
    if stopped_by(status) == signal.SIGTERM:
        status, said = run(program, folder, words + ["-o", "alone", "--resume"], 3 * RUN_SECONDS)
        if stopped_by(status) == signal.SIGTERM:
            return "too long"
        if status not in (0, 1):
            raise Found("status %d when resumed: %r" % (status, said))
    if status not in (0, 1):
        raise Found("status %d: %r" % (status, said))
    if b"File too large" in said or b"more memory than there is" in said:
        return "too large"
    if status == 1 and not said:
        raise Found("failed without a word")
    if not (folder / "alone" / "summary.json").exists():
        raise Found("status %d and no summary: %r" % (status, said))
    moments = [rng.random() * 1.1 * taken for _ in range(rng.randint(1, 3))]
    for moment in moments:
        kill = rng.choice(KILLS)
        ended, heard = run(program, folder, words + ["-o", "killed", "--resume"], moment, kill)
        if ended not in (0, 1) and stopped_by(ended) != kill:
            raise Found("status %d after signal %d: %r" % (ended, kill, heard))
    ended, heard = run(program, folder, words + ["-o", "killed", "--resume"], 6 * RUN_SECONDS)
    if stopped_by(ended) == signal.SIGTERM:
        return "too long"
    if ended != status:
        raise Found("status %d left alone, %d resumed: %r, %r" % (status, ended, said, heard))
    differ = differing(folder / "alone", folder / "killed")
    if differ:
        raise Found("not the same bits after %d kills: %s" % (len(moments), ", ".join(differ)))
    return "compared" if status == 0 else "failed alike"


def keep(folder, seed, words, why):
    found = pathlib.Path("soak-found") / str(seed)
    shutil.rmtree(found, ignore_errors=True)
    shutil.copytree(folder, found)
    (found / "why").write_text("%s\ntomlin run %s\n" % (why, " ".join(map(repr, words))))
    print("seed %d: %s: %s" % (seed, found, why), flush=True)


def main():
    project, program = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    seconds = float(sys.argv[3] if len(sys.argv) > 3
                    else os.environ.get("TOMLIN_SOAK_SECONDS", DEFAULT_SECONDS))
    seed = int(sys.argv[4]) if len(sys.argv) > 4 else int(time.time())
    scenes = sorted(project.glob("scenarios/*/*.toml"))
    texts = [scene.read_text() for scene in scenes]
    print("soak: %d scenes, %g s, seed %d" % (len(scenes), seconds, seed), flush=True)
    until = time.monotonic() + seconds
    counts, faults = {}, 0
    while True:
        rng = random.Random(seed)
        index = rng.randrange(len(scenes))
        with tempfile.TemporaryDirectory(prefix="tomlin-soak-") as name:
            folder = pathlib.Path(name)
            (folder / "scene.toml").write_text(mutated(texts[index], texts, rng))
            words = ["scene.toml", *settings_of(rng)]
            try:
                outcome = go_through(program, folder, words, rng)
            except (Found, ValueError, OSError) as error:
                outcome = "found"
                faults += 1
                keep(folder, seed, words, "%s: %s" % (scenes[index].name, error))
            counts[outcome] = counts.get(outcome, 0) + 1
        seed += 1
        if time.monotonic() >= until:
            break
    print("soak: " + ", ".join("%d %s" % (n, what) for what, n in sorted(counts.items())))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
