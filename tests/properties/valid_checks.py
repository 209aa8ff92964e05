#!/usr/bin/env python3
"""Whether `tomlin check` passes random valid scenes.

    python3 tests/properties/valid_checks.py PROGRAM [--seeds FROM TO]

Each scene of valid_scenes.py is checked, and has no warning that it is probably not what was meant; one
that is refused (a contact too close to bind, say) counts as neither. A thousand scenes take some minutes. That faults in the same scenes are found is the
subject of tests/forcefields/random_faults_test.cpp.

Exit status: 0 no valid scene fails or is warned of, and few are refused; 1 not so; 2 bad arguments.
"""

import argparse
import collections
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

from valid_scenes import ValidScene

MOST_REFUSED = 0.15  # of all scenes; contacts, misfits in a box
UNINTENDED = {"component.no_species", "component.other_units", "run.far_above_barriers"}
LONGEST = 120.0  # seconds for one scene; all take less than one


def checked(program, folder, seed):
    """Status, and the checks that failed with their texts."""
    scene = folder / f"{seed}.toml"
    scene.write_text(ValidScene(seed).text())
    def answer_of(command):
        done = subprocess.run([program, command, scene, "--json"], capture_output=True, text=True,
                              timeout=LONGEST)
        return done, json.loads(done.stdout)

    done, answer = answer_of("check")
    if done.returncode == 2:
        return "refused", [str(answer["faults"][0]["why"])]
    failed = [f"{one['subject']} ({one.get('type')}) {one['text']}" for one in answer["checks"]
              if not one["ok"]]
    failed += sorted(UNINTENDED.intersection(answer_of("explain")[1]["warning_codes"]))
    return ("failed" if failed or done.returncode else "ok"), failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", nargs=2, type=int, default=(0, 150))
    given = parser.parse_args()
    seeds = range(*given.seeds)
    counts = collections.Counter()
    with tempfile.TemporaryDirectory(prefix="tomlin-valid-") as name, \
            concurrent.futures.ThreadPoolExecutor(2) as pool:
        folder = pathlib.Path(name)
        answers = pool.map(lambda seed: checked(given.program, folder, seed), seeds)
        for seed, (verdict, texts) in zip(seeds, answers):
            counts[verdict] += 1
            if verdict == "failed":
                print(f"{seed}: " + "; ".join(texts))
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    few = counts["refused"] <= MOST_REFUSED * len(seeds)
    return 0 if counts["failed"] == 0 and counts["ok"] > 0 and few else 1


if __name__ == "__main__":
    sys.exit(main())
