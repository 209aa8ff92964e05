"""Every example runs: those of docstrings, of pages, and the scripts under scenarios/."""

import doctest
import importlib
import pathlib
import pkgutil
import re
import runpy
import shutil

import pytest
from conftest import ROOT

import tomlin

MODULES = ["tomlin", *(f"tomlin.{one.name}" for one in pkgutil.iter_modules(tomlin.__path__)
                       if one.name != "_core")]
PAGES = ["README.md", "framework/python/README.md"]
SCRIPTS = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("scenarios/*/*_notebook.py"))


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name):
    failed, _ = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert failed == 0


def test_public_things_are_documented():
    for name in tomlin.__all__:
        thing = getattr(tomlin, name)
        assert name == "__version__" or thing.__doc__, name
        for key, value in vars(thing).items() if isinstance(thing, type) else ():
            if not key.startswith("_") and (callable(value) or isinstance(value, property)):
                assert value.__doc__, f"{name}.{key}"


@pytest.fixture
def in_a_copy(tmp_path, monkeypatch):
    """A folder like the checkout, for what writes files."""
    for entry in ROOT.iterdir():
        if not entry.name.startswith((".", "build")):
            (tmp_path / entry.name).symlink_to(entry)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("page", PAGES)
def test_python_blocks_of_pages(page, in_a_copy):
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
    assert blocks, f"{page} has no example"
    names = {"__name__": "__main__"}
    for block in blocks:
        exec(compile(block, page, "exec"), names)  # one after the other, as a reader would
    if page == "README.md":  # the first loop that a reader sees has its friction
        driver = names["loop"].driver
        assert driver.half_difference == pytest.approx((driver.trace - driver.retrace) / 2) and driver.loops > 0


@pytest.mark.parametrize("script", SCRIPTS)
def test_scripts(script, in_a_copy):
    runpy.run_path(script, run_name="__main__")


def test_there_are_scripts():
    assert len(SCRIPTS) >= 2 and shutil.which("python3") and pathlib.Path("scenarios").is_dir()
