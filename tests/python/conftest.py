"""The tests of the Python module. `./dev test` runs them; by hand, from the checkout:

    PYTHONPATH=build/python TOMLIN_BUILD=build python3 -m pytest tests/python
"""

import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("TOMLIN_BUILD", ROOT / "build")).resolve()
TIP = "scenarios/prandtl_tomlinson/stick_slip.toml"

os.environ.setdefault("MPLBACKEND", "agg")
sys.path.insert(0, str(ROOT / "tests" / "determinism"))


@pytest.fixture(autouse=True)
def in_the_checkout(monkeypatch):
    """Scenes are named as in the pages."""
    monkeypatch.chdir(ROOT)


@pytest.fixture
def program():
    return str(BUILD / "bin" / "tomlin")


@pytest.fixture
def tip():
    """A tip that sticks and slips: a run of some milliseconds."""
    import tomlin

    return tomlin.load(TIP).set("v", 0.01)
