"""Nanotubes and graphene as ASE builds them, and files of extended XYZ that go from one program to
the other.

geometry_oracle_test.py TOMLIN: exits with 77, "skipped", where ASE is not installed.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import ase
    import ase.build
    import ase.io
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-ase)")
    sys.exit(77)

BOND = 1.42
ROUNDINGS = 1e-9  # ASE's own coordinates have errors of 1e-12, its files 1e-8 (see below)
# In units of the last digit of the largest coordinate: positions are kept relative to an origin
# that follows a body, which is subtracted once and added once.
ROUNDINGS_OF_ORIGIN = 2.0
RUN = """
[run]
duration = 0.01
integrator = { type = "rk4", dt = 0.01 }

[output]
every = 0.01
trajectory = true
trajectory_format = "xyz"
"""


class Oracle(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())

    def tearDown(self):
        shutil.rmtree(self.folder)

    def run_scene(self, text):
        """The first frame that a scene leaves, as ASE reads it."""
        (self.folder / "scene.toml").write_text(text + RUN)
        subprocess.run([TOMLIN, "run", self.folder / "scene.toml", "-o", self.folder / "out",
                        "--force"], check=True, stdout=subprocess.DEVNULL)
        return ase.io.read(self.folder / "out" / "trajectory.xyz", index=0)

    def body(self, kind, keys):
        return self.run_scene(f'[[body]]\ntype = "{kind}"\nbond_length = {BOND}\n{keys}\n'
                              'particle_mass = 12.011\nspecies = "C"\n')

    def assert_same_distances(self, found, due):
        """All distances of all pairs, in order: the same shape, or its image in a mirror."""
        self.assertEqual(len(found), len(due))
        difference = np.sort(found.get_all_distances().ravel()) - np.sort(
            due.get_all_distances().ravel())
        self.assertLess(np.max(np.abs(difference)), ROUNDINGS)

    def test_nanotubes(self):
        for n, m, cells in ((10, 0, 2), (9, 0, 1), (5, 5, 3), (6, 6, 1), (4, 2, 2), (8, 2, 1),
                            (7, 3, 1), (5, 1, 1), (6, 4, 2)):
            with self.subTest(f"({n}, {m})"):
                found = self.body("nanotube", f"chirality = [{n}, {m}]\ncells = {cells}")
                due = ase.build.nanotube(n, m, length=cells, bond=BOND)
                # Both repeat with the same length; ASE may cut elsewhere along the axis.
                length = due.cell[2, 2]
                for atoms, axis in ((found, 0), (due, 2)):
                    atoms.set_cell([1e3, 1e3, 1e3])
                    cell = atoms.cell.array.copy()
                    cell[axis, axis] = length
                    atoms.set_cell(cell)
                    atoms.set_pbc([k == axis for k in range(3)])
                self.assertEqual(len(found), len(due))
                difference = (np.sort(found.get_all_distances(mic=True).ravel())
                              - np.sort(due.get_all_distances(mic=True).ravel()))
                self.assertLess(np.max(np.abs(difference)), ROUNDINGS)

    def test_graphene(self):
        found = self.body("graphene", "cells = [3, 4]")
        # A ribbon of ASE along z is across x there: as many atoms, and the same lattice.
        due = ase.build.graphene(a=np.sqrt(3.0) * BOND, vacuum=10.0)
        due = due.repeat((4, 6, 1))
        self.assertEqual(len(found), len(due))
        for atoms, cell in ((found, np.diag([9.0 * BOND, 4.0 * np.sqrt(3.0) * BOND, 1e3])),
                            (due, due.cell.array)):
            atoms.set_cell(cell)
            atoms.set_pbc([True, True, False])
            # Shells of neighbours of each atom: 3 at b, 6 at sqrt(3) b, 3 at 2 b.
            near = atoms.repeat((3, 3, 1))
            middle = near.positions[4 * len(atoms):5 * len(atoms)]
            apart = np.linalg.norm(near.positions[None] - middle[:, None], axis=2)
            for shell, count in ((1.0, 3), (np.sqrt(3.0), 6), (2.0, 3)):
                at = np.abs(apart - shell * BOND) < ROUNDINGS
                self.assertTrue(np.all(at.sum(axis=1) == count))

    def test_files_of_ase(self):
        """Positions, species, masses and velocities of a file that ASE writes."""
        molecule = ase.build.molecule("CH3CH2OH")
        molecule.set_array("velo", np.arange(27.0).reshape(9, 3) / 8.0)
        # ASE 3.22 writes masses only where they are an array of the molecule's own.
        molecule.set_masses(molecule.get_masses())
        for columns in (None, ["symbols", "positions", "masses", "velo"]):
            file = self.folder / "molecule.xyz"
            ase.io.write(file, molecule, format="extxyz", columns=columns)
            mass = "" if columns else "particle_mass = 1.0\n"
            found = self.run_scene(f'[[body]]\ntype = "particles"\nfile = "{file.name}"\n{mass}')
            self.assertEqual(found.get_chemical_symbols(), molecule.get_chemical_symbols())
            # Files of ASE have eight decimals.
            self.assertLess(np.max(np.abs(found.positions - molecule.positions)), 1e-8)
            if not columns:
                continue
            scene = (self.folder / "out" / "scene.toml").read_text()
            self.assertIn("velocity = [[0.0, 0.125, 0.25], ", scene)
            self.assertIn("particle_mass = [12.011, 12.011, 15.999, 1.008, ", scene)

    def test_files_of_tomlin(self):
        """What a run leaves starts another one."""
        text = ('[[body]]\ntype = "nanotube"\nchirality = [4, 2]\nbond_length = 1.42\ncells = 1\n'
                'roll = 0.1\nparticle_mass = 12.011\nspecies = "C"\nvelocity = [0.3, 0.2, 0.1]\n')
        first = self.run_scene(text)
        shutil.copy(self.folder / "out" / "trajectory.xyz", self.folder / "again.xyz")
        last = ase.io.read(self.folder / "again.xyz", index=-1)
        again = self.run_scene('[[body]]\ntype = "particles"\nfile = "again.xyz"\n'
                               'particle_mass = 12.011\n')
        rounding = ROUNDINGS_OF_ORIGIN * np.spacing(np.max(np.abs(last.positions)))
        self.assertLessEqual(np.max(np.abs(again.positions - last.positions)), rounding)
        # Another frame of the file is seen.
        self.assertGreater(np.max(np.abs(again.positions - first.positions)), rounding)
        self.assertEqual(again.get_chemical_symbols(), ["C"] * 56)


if __name__ == "__main__":
    TOMLIN = sys.argv.pop(1)
    unittest.main()
