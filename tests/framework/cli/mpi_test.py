#!/usr/bin/env python3
"""A sweep that several processes share, as mpirun starts them: the files of one process, whatever
becomes of the processes on the way. Without MPI the processes refuse to run the same sweep each.

usage: mpi_test.py TOMLIN

Exit status: 0 all is so, 1 it is not, 77 there is no mpirun or no module for it.
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
MODULE = PROGRAM.parent.parent / "lib/tomlin/tomlin_mpi.so"
SKIPPED = 77
SECONDS = 120  # until something hangs

SCENE = """
[parameters]
v = 1e-2
[[body]]
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = ["v"]
[[force]]
type = "viscous_damping"
coefficient = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 100.0
integrator = { type = "rk4", dt = 1e-2 }
[output]
every = 1.0
[sweep]
over = { v = "1e-3:1e-1:40:log", "run.integrator.dt" = [1e-2, -1.0, 50.0] }
observables = ["driver.mean_force.x", "events.slips"]
"""

# Tens of batches of points that step together, a fraction of a second each, so that a sweep that is
# stopped four times after its first batch has some left.
LONG = ("--over", "v=1e-3:1e-1:400:log", "--set", "run.duration=16000")


def environment(**more):
    """That of this process, without what a launcher may have set, where root may start mpirun."""
    kept = {name: value for name, value in os.environ.items()
            if not name.startswith(("OMPI_", "PMI", "SLURM_"))}
    return kept | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"} | more


class Folder(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        (self.folder / "tip.toml").write_text(SCENE)

    def start(self, *command, **more):
        return subprocess.Popen([str(word) for word in command], cwd=self.folder, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                env=environment(**more))

    def run_command(self, *command, **more):
        process = self.start(*command, **more)
        process.out, process.err = process.communicate(timeout=SECONDS)
        return process

    def results(self, name):
        summary = json.loads((self.folder / name / "sweep.json").read_text())
        del summary["performance"]
        return [summary] + [(self.folder / name / file).read_bytes()
                            for file in ("sweep.csv", "sweep.h5", "scene.toml")]


class WithoutMpi(Folder):
    """Launchers are known by what they set in the environment."""

    def test_processes_without_the_module_run_nothing(self):
        (self.folder / "bin").mkdir()
        alone = self.folder / "bin/tomlin"
        shutil.copy(PROGRAM, alone)
        for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"):
            ended = self.run_command(alone, "sweep", "tip.toml", **{name: "4"})
            self.assertEqual(ended.returncode, 2, ended.err)
            self.assertIn("4 processes", ended.err)
            self.assertIn("tomlin_mpi.so", ended.err)
            self.assertIn("[command.conflict]", ended.err)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["bin", "tip.toml"])

    def test_what_is_no_launcher_of_several(self):
        for number, more in enumerate([{"OMPI_COMM_WORLD_SIZE": "1", "SLURM_STEP_NUM_TASKS": "4"},
                                       {"SLURM_NTASKS": "4", "SLURM_PROCID": "0"},
                                       {"PMI_SIZE": ""}]):
            ended = self.run_command(PROGRAM, "sweep", "tip.toml", "-o", number, **more)
            self.assertEqual(ended.returncode, 0, ended.err)

    def test_shards_that_are_started_together_are_alone(self):
        ended = self.run_command(PROGRAM, "sweep", "tip.toml", "--shard", "2/4", PMI_SIZE="4")
        self.assertEqual(ended.returncode, 0, ended.err)
        self.assertTrue((self.folder / "tip.sweep.2-of-4.out/sweep.json").exists())


class WithMpi(Folder):
    def mpirun(self, processes, *arguments):
        return ["mpirun", "--oversubscribe", "-n", processes, PROGRAM, "sweep", *arguments]

    def one_process(self, *arguments):
        ended = self.run_command(PROGRAM, "sweep", "tip.toml", "-o", "one", "--quiet", *arguments)
        self.assertEqual(ended.returncode, 0, ended.err)

    def test_the_files_are_those_of_one_process(self):
        self.one_process()
        for processes, options in ((2, []), (4, []), (3, ["--threads", "2", "--trace", "0,3,6"])):
            name = f"of_{processes}"
            ended = self.run_command(*self.mpirun(processes, "tip.toml", "-o", name, *options))
            self.assertEqual(ended.returncode, 0, ended.err)
            self.assertEqual(ended.out.count("40 points finished, 40 failed, 40 refused"), 1)
            self.assertEqual(self.results(name), self.results("one"))
        for point in (0, 3, 6):
            self.assertTrue((self.folder / f"of_3/sweep.points/{point}/summary.json").exists())

    def test_refined_in_rounds(self):
        refine = ["--over", "run.integrator.dt=1e-2,-1.0", "--over", "v=1e-3:1e-1:5:log",
                  "--refine", "driver.mean_force.x=0.25"]
        self.one_process(*refine)
        intervals = json.loads((self.folder / "one/sweep.json").read_text())["refine"]["intervals"]
        self.assertEqual([one["status"] for one in intervals], ["found", "none"])
        for processes, options in ((2, []), (4, []), (3, ["--threads", "2"])):
            name = f"of_{processes}"
            ended = self.run_command(*self.mpirun(processes, "tip.toml", "-o", name, *refine,
                                                  *options))
            self.assertEqual(ended.returncode, 0, ended.err)
            self.assertEqual(self.results(name), self.results("one"))

    def test_processes_of_another_mpi_run_nothing(self):
        ended = self.run_command(PROGRAM, "sweep", "tip.toml", PMI_SIZE="4")
        self.assertEqual(ended.returncode, 2, ended.err)
        self.assertIn("not the launcher's", ended.err)
        self.assertFalse((self.folder / "tip.sweep.out").exists())

    def test_input_that_is_wrong_is_reported_once(self):
        for arguments in (["none.toml"], ["tip.toml", "--observable", "driver.men_force.x"],
                          ["tip.toml", "--over", "v=1:2"]):
            ended = self.run_command(*self.mpirun(4, *arguments, "-o", "x"))
            self.assertEqual(ended.returncode, 2, ended.err)
            self.assertEqual(ended.err.count(": error: "), 1, ended.err)
        self.assertFalse((self.folder / "x").exists())

    def test_input_that_one_process_lacks(self):
        script = 'if [ "$OMPI_COMM_WORLD_RANK" = 2 ]; then cd bin; fi; exec "$0" "$@"'
        (self.folder / "bin").mkdir()
        ended = self.run_command("mpirun", "--oversubscribe", "-n", 4, "sh", "-c", script, PROGRAM,
                                 "sweep", "tip.toml", "-o", "x")
        self.assertEqual(ended.returncode, 2, ended.err)
        self.assertEqual(ended.err.count("process 2: error: "), 1, ended.err)
        self.assertFalse((self.folder / "x").exists())

    def started(self, name):
        """A sweep of three processes that has rows; mpirun, and its children in order."""
        process = self.start(*self.mpirun(3, "tip.toml", "-o", name, *LONG))
        journal = self.folder / name / "sweep.journal"
        until = time.monotonic() + SECONDS
        size = None
        while time.monotonic() < until:
            self.assertIsNone(process.poll(), "the sweep ended before it could be stopped")
            time.sleep(0.02)
            if not journal.exists():
                continue
            size = size if size is not None else journal.stat().st_size
            if journal.stat().st_size > size:
                break
        found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process.pid)],
                               capture_output=True, text=True, check=True).stdout
        children = sorted(int(pid) for pid in found.split())
        self.assertEqual(len(children), 3)
        return process, children

    def test_processes_that_die_are_replaced_by_the_same_command(self):
        self.one_process(*LONG)
        kills = 0
        for victim, number in ((2, signal.SIGKILL), (0, signal.SIGKILL), (1, signal.SIGTERM),
                               (0, signal.SIGINT)):
            process, children = self.started("a")
            os.kill(children[victim], number)
            _, errors = process.communicate(timeout=SECONDS)
            kills += process.returncode != 0
            if number != signal.SIGKILL and process.returncode != 0:
                self.assertEqual(process.returncode, 128 + number, errors)
                summary = json.loads((self.folder / "a/sweep.json").read_text())
                self.assertEqual(summary["status"], "interrupted")
                self.assertGreater(summary["performance"]["rows"], 0)
        self.assertGreater(kills, 1)
        ended = self.run_command(*self.mpirun(3, "tip.toml", "-o", "a", *LONG))
        self.assertEqual(ended.returncode, 0, ended.err)
        self.assertEqual(self.results("a"), self.results("one"))


def main():
    suite = unittest.TestSuite()
    load = unittest.defaultTestLoader.loadTestsFromTestCase
    suite.addTests(load(WithoutMpi))
    reason = None
    if not MODULE.exists():
        reason = f"there is no {MODULE}: tomlin was built without MPI"
    elif shutil.which("mpirun") is None:
        reason = "there is no mpirun"
    else:
        suite.addTests(load(WithMpi))
    if not unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful():
        return 1
    if reason:
        print("skipped with mpirun:", reason)
        return SKIPPED
    return 0


if __name__ == "__main__":
    sys.exit(main())
