"""Trajectories as others read them: by h5py, and by the rules of H5MD (h5md_check.py). That the
rules are looked at shows by files that break each of them.

    h5md_check_test.py SAMPLES    SAMPLES WRITES FOLDER with the files two_bodies.h5, line.h5 and
                                  metal.h5
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

import h5md_check

SAMPLES = None
ALL = "particles/all"


def place_of(frame, k):
    """As trajectory_fixture.hpp has it."""
    return 1e9 / 3.0 + 0.1 * frame - k / 7.0


class Trajectory(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        subprocess.run([SAMPLES, cls.folder], check=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_keeps_the_rules(self):
        for name in ("two_bodies.h5", "species.h5", "line.h5", "metal.h5"):
            self.assertEqual(h5md_check.faults(self.folder / name), [])

    def test_has_the_numbers_of_the_run(self):
        with h5py.File(self.folder / "two_bodies.h5", "r") as file:
            particles = file[ALL]
            value = particles["position/value"]
            self.assertEqual(value.dtype, np.dtype("<f8"))
            self.assertEqual(value.shape, (5, 4, 3))
            for f in range(5):
                for k in range(8):
                    self.assertEqual(value[f, k // 2, k % 2], place_of(f, k))
            self.assertTrue(np.all(value[..., 2] == 0.0))
            self.assertEqual(list(particles["position/time"]), [0.1 * f for f in range(5)])
            self.assertEqual(list(particles["position/step"]), list(range(5)))
            self.assertEqual(list(particles["mass"]), [0.25, 0.5, 0.125, 2.0])
            self.assertEqual(list(particles["species"]), [0, 0, 0, 1])
            self.assertNotIn("body", particles)
            self.assertNotIn("species", file["parameters"])
            self.assertEqual(list(particles["box"].attrs["boundary"]),
                             [b"periodic", b"none", b"none"])
            self.assertTrue(np.all(particles["box/edges/value"][()] == [7.5, 0.0, 0.0]))

    def test_has_the_species_of_particles(self):
        with h5py.File(self.folder / "species.h5", "r") as file:
            self.assertEqual(list(file["parameters/species"]), [b"C", b"H", b"X"])
            self.assertEqual(list(file[ALL]["species"]), [1, 0, 0, 2])
            self.assertEqual(list(file[ALL]["body"]), [0, 0, 0, 1])

    def test_says_what_it_is(self):
        with h5py.File(self.folder / "two_bodies.h5", "r") as file:
            self.assertEqual(file["h5md/creator"].attrs["name"], b"tomlin")
            self.assertEqual(file["h5md/creator"].attrs["version"], b"0.1.0")
            self.assertEqual(file["h5md/modules/units"].attrs["system"], "reduced")
            self.assertEqual(file["parameters"].attrs["name"], b'a "test"')
            self.assertEqual(file["parameters/scene"][()], b"[run]\nduration = 1.0\n")
            self.assertEqual(list(file["parameters/bodies"]), [b"ring", b"tip"])
            for path, dimension in {"position/value": b"length", "position/time": b"time",
                                    "mass": b"mass", "box/edges/value": b"length"}.items():
                self.assertEqual(file[ALL][path].attrs["dimension"], dimension)

    def test_reduced_units_have_no_symbols(self):
        with h5py.File(self.folder / "two_bodies.h5", "r") as file:
            for path in ("position/value", "position/time", "mass", "box/edges/value"):
                self.assertNotIn("unit", file[ALL][path].attrs)

    def test_metal_units_have_symbols(self):
        """As MDAnalysis looks them up: text, not bytes."""
        with h5py.File(self.folder / "metal.h5", "r") as file:
            self.assertEqual(file["h5md/modules/units"].attrs["system"], "metal")
            for path, unit in {"position/value": "Angstrom", "position/time": "ps", "mass": "u",
                               "box/edges/value": "Angstrom"}.items():
                self.assertEqual(file[ALL][path].attrs["unit"], unit)
            self.assertNotIn("unit", file[ALL]["position/step"].attrs)
            self.assertEqual(file[ALL]["position/value"].attrs["dimension"], b"length")

    def test_without_a_box_has_no_edges(self):
        with h5py.File(self.folder / "line.h5", "r") as file:
            self.assertNotIn("edges", file[ALL]["box"])
            self.assertEqual(list(file[ALL]["box"].attrs["boundary"]), [b"none"] * 3)
            self.assertTrue(np.all(file[ALL]["position/value"][..., 1:] == 0.0))

    def test_what_is_not_complete_does_not_open(self):
        whole = (self.folder / "two_bodies.h5").read_bytes()
        part = self.folder / "cut.h5"
        for size in (0, 100, len(whole) // 2, len(whole) - 1):
            part.write_bytes(whole[:size])
            self.assertNotEqual(h5md_check.faults(part), [], size)

    def test_of_a_killed_run_does_not_open(self):
        part = self.folder / "killed.h5.part"
        self.assertTrue(part.exists())
        self.assertFalse((self.folder / "killed.h5").exists())
        self.assertIn("does not open", h5md_check.faults(part)[0])

    def broken(self, change):
        path = self.folder / "broken.h5"
        shutil.copy(self.folder / "two_bodies.h5", path)
        with h5py.File(path, "r+") as file:
            change(file)
        return h5md_check.faults(path)

    def test_the_check_sees_every_fault(self):
        def drop(path):
            return lambda file: file.__delitem__(path)

        def drop_attribute(path, name):
            return lambda file: file[path].attrs.__delitem__(name)

        def put_attribute(path, name, value):
            return lambda file: file[path].attrs.__setitem__(name, value)

        def replace(path, values, **options):
            def change(file):
                del file[path]
                file.create_dataset(path, data=values, **options)

            return change

        places = np.zeros((5, 4, 3))
        growing = {"maxshape": (None, 4, 3), "chunks": (5, 4, 3)}
        faults = {
            "no h5md": drop("h5md"),
            "no version": drop_attribute("h5md", "version"),
            "another version": put_attribute("h5md", "version", np.array([1, 0])),
            "no author": drop("h5md/author"),
            "no name of the author": drop_attribute("h5md/author", "name"),
            "a name of variable length": put_attribute("h5md/author", "name", "unknown"),
            "no creator": drop("h5md/creator"),
            "no version of the program": drop_attribute("h5md/creator", "version"),
            "no version of the module": drop_attribute("h5md/modules/units", "version"),
            "no system of units": drop_attribute("h5md/modules/units", "system"),
            "a unit as bytes": put_attribute(f"{ALL}/mass", "unit", np.bytes_("u")),
            "a unit that is a quotient": put_attribute(f"{ALL}/mass", "unit", "eV/A"),
            "no box": drop(f"{ALL}/box"),
            "no dimension": drop_attribute(f"{ALL}/box", "dimension"),
            "two axes": put_attribute(f"{ALL}/box", "dimension", np.int32(2)),
            "no boundary": drop_attribute(f"{ALL}/box", "boundary"),
            "another boundary": put_attribute(f"{ALL}/box", "boundary",
                                              np.array([b"open", b"none", b"none"])),
            "a periodic box without edges": drop(f"{ALL}/box/edges"),
            "edges of two axes": replace(f"{ALL}/box/edges/value", np.zeros((5, 2)),
                                         maxshape=(None, 2), chunks=(5, 2)),
            "another step of the edges": replace(f"{ALL}/box/edges/step", np.arange(5)),
            "no value": drop(f"{ALL}/position/value"),
            "no step": drop(f"{ALL}/position/step"),
            "steps that are not whole": replace(f"{ALL}/position/step", np.arange(5.0)),
            "steps that stand still": replace(f"{ALL}/position/step", np.zeros(5, int)),
            "too few times": replace(f"{ALL}/position/time", np.arange(4.0)),
            "times that run back": replace(f"{ALL}/position/time", -np.arange(5.0)),
            "positions in single precision": replace(f"{ALL}/position/value",
                                                     places.astype("f4"), **growing),
            "positions that cannot grow": replace(f"{ALL}/position/value", places),
            "positions of two axes": replace(f"{ALL}/position/value", places[..., :2],
                                             maxshape=(None, 4, 2), chunks=(5, 4, 2)),
            "positions in one row": replace(f"{ALL}/position/value", places[:, 0, :],
                                            maxshape=(None, 3), chunks=(5, 3)),
            "too few masses": replace(f"{ALL}/mass", np.ones(3)),
            "masses in single precision": replace(f"{ALL}/mass", np.ones(4, "f4")),
            "species that are not whole": replace(f"{ALL}/species", np.ones(4)),
            "the same particle twice": replace(f"{ALL}/id", np.array([0, 1, 1, 2])),
        }
        self.assertEqual(self.broken(lambda file: None), [])
        for name, change in faults.items():
            with self.subTest(name):
                self.assertNotEqual(self.broken(change), [])


if __name__ == "__main__":
    SAMPLES = sys.argv.pop(1)
    unittest.main()
