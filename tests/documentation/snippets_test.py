#!/usr/bin/env python3
"""Runs the commands and scenes of the pages.

    python3 tests/documentation/snippets_test.py SOURCE_DIR PROGRAM

Every block fenced as ```sh is run by bash from a folder that looks like the project's after
./dev build; a block fenced as ```sh long is not run, and ```sh library is left to library_test.py.
A block fenced as ```text printed must be part of what the commands before it have printed.
A block fenced as ```toml is a whole scene, and is run by the program; one fenced as ```toml kim is,
where the plugin with models of the KIM API was built and the scene's model is installed. Lines that
start with ./dev are not run: their command must be one that `./dev help` names. The blocks of one
page are run in order, in one folder. Pages that the program or the tests generate are left out.

Exit status: 0 all went well, 1 one did not, 2 bad arguments.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

from pages import is_generated, pages_of

# Pages that would be useless without commands.
MUST_HAVE_BLOCKS = ("README.md",) + tuple(
    f"framework/guide/{name}.md" for name in (
        "accuracy", "atoms", "bodies", "commands", "figures", "forces", "formulas", "integrators",
        "recipes", "results", "scenes", "sweeps", "temperature", "units"))

SECONDS_PER_BLOCK = 900  # a snippet that takes longer has no place in an `sh` block

FENCE = re.compile(r"^```(.*)$")
DEV = re.compile(r"^\s*\./dev\b\s*(\S*)")
KIM_MODEL = re.compile(r'^model = "(.*)"$', re.MULTILINE)


class Block:
    """A fenced block: its info string, the line of its first command, its lines."""

    def __init__(self, info, line):
        self.info = info
        self.line = line
        self.lines = []


def blocks_of(text):
    """All fenced blocks; raises ValueError when the last one is left open."""
    blocks = []
    current = None
    for number, line in enumerate(text.splitlines(), start=1):
        fence = FENCE.match(line)
        if fence and current is None:
            current = Block(fence.group(1).strip(), number + 1)
        elif fence:
            blocks.append(current)
            current = None
        elif current is not None:
            current.lines.append(line)
    if current is not None:
        raise ValueError(f"the block that begins in line {current.line} is not closed")
    return blocks


def dev_commands(source):
    """The commands that ./dev knows, by its own help."""
    text = subprocess.run([str(source / "dev"), "help"], capture_output=True, text=True,
                          check=True).stdout
    return set(re.findall(r"^  (\w+)\b", text, flags=re.MULTILINE))


def lay_out(folder, source, program):
    """A folder like the project's, with the program where ./dev build leaves it."""
    for entry in source.iterdir():
        if not entry.name.startswith((".", "build")):
            (folder / entry.name).symlink_to(entry)
    (folder / "build" / "bin").mkdir(parents=True)
    (folder / "build" / "bin" / "tomlin").symlink_to(program)
    (folder / "build" / "lib").symlink_to(program.parent.parent / "lib")


def why_no_kim(block, folder):
    """Why a scene with a model of the KIM API cannot be run here, or None."""
    if not (folder / "build/lib/tomlin/libtomlin_kim.so").exists():
        return "the plugin with kim_model is not built"
    model = KIM_MODEL.search("\n".join(block.lines)).group(1)
    listed = subprocess.run(["kim-api-collections-management", "list"], capture_output=True,
                            text=True, check=False, cwd=folder).stdout.split()
    return None if model in listed else f"no {model}: it is in openkim-models"


def commands_of(block, folder, commands):
    """What bash is to run for a block, and why it cannot be; one of them is None."""
    if block.info in ("toml", "toml kim"):
        scene = folder / f"scene_of_line_{block.line}.toml"
        scene.write_text("\n".join(block.lines) + "\n", encoding="utf-8")
        return f"build/bin/tomlin run {scene.name}", None
    kept = []
    for line in block.lines:
        dev = DEV.match(line)
        if dev is None:
            kept.append(line)
        elif dev.group(1) not in commands:
            return None, f"./dev has no command \"{dev.group(1)}\""
        else:
            kept.append("")  # keeps bash's line numbers
    return "\n".join(kept), None


def run_block(block, folder, commands):
    """What the block prints, and why it fails, or None."""
    script, why = commands_of(block, folder, commands)
    if why:
        return "", why
    try:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False,
                              timeout=SECONDS_PER_BLOCK)
    except subprocess.TimeoutExpired:
        return "", f"takes longer than {SECONDS_PER_BLOCK} s"
    if done.returncode != 0:
        return "", f"ends with status {done.returncode}:\n{done.stdout.rstrip()}"
    return done.stdout, None


def why_not_printed(block, printed):
    """Why the lines of a block are not what the commands before it have printed, or None."""
    text = "\n".join(block.lines)
    if text.strip() and f"\n{text}\n" in f"\n{printed}\n":
        return None
    return f"the commands before it print something else:\n{printed.rstrip()}"


def check_page(page, source, program, commands):
    """Runs the blocks of one page; returns how many were run, and the complaints."""
    run = 0
    complaints = []
    try:
        blocks = blocks_of(page.read_text(encoding="utf-8"))
    except ValueError as error:
        return 0, [f"{page}: {error}"]
    with tempfile.TemporaryDirectory(prefix="tomlin-snippets-") as name:
        folder = pathlib.Path(name)
        lay_out(folder, source, program)
        printed = ""
        for block in blocks:
            if block.info == "text printed" and (why := why_not_printed(block, printed)):
                complaints.append(f"{page}:{block.line}: {why}")
            if block.info not in ("sh", "toml", "toml kim"):
                continue
            if block.info == "toml kim" and (why := why_no_kim(block, folder)):
                print(f"{page}:{block.line}: skipped: {why}")
                continue
            run += 1
            printed, why = run_block(block, folder, commands)
            if why:
                complaints.append(f"{page}:{block.line}: {why}")
    return run, complaints


def sees_faults(source, program, commands):
    """Planted faults, which must all be noticed; and what must not be taken for one."""
    faulty = ["```sh\nfalse\n```\n", "```sh\n./dev nonsense\n```\n", "```sh\ntrue\n",
              "```sh\nbuild/bin/tomlin run no_such_scene.toml\n```\n", "```sh\nfalse | cat\n```\n",
              "```toml\n[run]\n```\n", "```text printed\n1\n```\n",
              "```sh\necho 1.25\n```\n```text printed\n1.2\n```\n",
              "```sh\necho 1\n```\n```sh\necho 2\n```\n```text printed\n1\n```\n"]
    sound = ["```sh\n./dev test\ntest -x build/bin/tomlin\n```\n", "```text\nfalse\n```\n",
             "```sh long\nfalse\n```\n",
             "```sh\nprintf '1\\n2\\n3\\n'\n```\n```text printed\n2\n3\n```\n"]
    with tempfile.TemporaryDirectory(prefix="tomlin-snippets-") as name:
        page = pathlib.Path(name) / "README.md"
        for text, is_faulty in [(t, True) for t in faulty] + [(t, False) for t in sound]:
            page.write_text(text, encoding="utf-8")
            _, complaints = check_page(page, source, program, commands)
            if bool(complaints) != is_faulty:
                print(f"the test itself is broken: {text!r} gives {complaints}", flush=True)
                return False
    return True


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    source = pathlib.Path(sys.argv[1]).resolve()
    program = pathlib.Path(sys.argv[2]).resolve()
    if not (source / "README.md").is_file() or not program.is_file():
        print(f"{source}/README.md and {program} must exist", file=sys.stderr)
        return 2
    commands = dev_commands(source)
    if not sees_faults(source, program, commands):
        return 1
    failed = False
    for page in pages_of(source):
        if is_generated(page):
            continue
        name = page.relative_to(source).as_posix()
        run, complaints = check_page(page, source, program, commands)
        must = name in MUST_HAVE_BLOCKS or name.startswith("scenarios/")
        if run or complaints or must:
            print(f"{name}: {run} blocks run, {len(complaints)} failed", flush=True)
        for complaint in complaints:
            print(complaint, flush=True)
        failed = failed or bool(complaints) or (must and run == 0)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
