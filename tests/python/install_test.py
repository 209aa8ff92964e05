"""The wheel that `pip install .` makes, without the build that comes before it."""

import ast
import base64
import csv
import hashlib
import importlib.util
import os
import re
import subprocess
import sys
import zipfile

import pytest
from conftest import BUILD, ROOT


@pytest.fixture(scope="module")
def backend():
    spec = importlib.util.spec_from_file_location(
        "build_backend", ROOT / "framework" / "python" / "build_backend.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.build = lambda: None
    module.BUILD = BUILD
    return module


@pytest.fixture(scope="module")
def built(backend, tmp_path_factory):
    """The wheel, which takes seconds to compress."""
    folder = tmp_path_factory.mktemp("wheel")
    return folder / backend.build_wheel(folder)


def test_wheel_is_whole_and_works(built, tmp_path):
    with zipfile.ZipFile(built) as wheel:
        names = wheel.namelist()
        record = next(one for one in names if one.endswith("RECORD"))
        rows = list(csv.reader(wheel.read(record).decode().splitlines()))
        assert sorted(row[0] for row in rows) == sorted(names)
        for path, digest, _ in rows:
            if digest:
                found = base64.urlsafe_b64encode(hashlib.sha256(wheel.read(path)).digest())
                assert digest == "sha256=" + found.rstrip(b"=").decode()
        wheel.extractall(tmp_path / "site")
    assert {"tomlin/py.typed", "tomlin/_core.pyi", "tomlin/__init__.py"} <= set(names)
    code = ("import tomlin, sys; print(tomlin.__file__); "
            "print(tomlin.load(sys.argv[1]).set('v', 0.1).run().status)")
    done = subprocess.run([sys.executable, "-c", code,
                           str(ROOT / "scenarios/prandtl_tomlinson/stick_slip.toml")],
                          cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(tmp_path / "site" / "tomlin" / "__init__.py"), "finished"]


def test_editable_wheel_points_to_the_build(backend, tmp_path):
    with zipfile.ZipFile(tmp_path / backend.build_editable(tmp_path)) as wheel:
        assert wheel.read("tomlin.pth").decode().strip() == str(BUILD / "python")


def test_metadata_are_those_of_the_wheel(backend, built, tmp_path):
    info = backend.prepare_metadata_for_build_wheel(tmp_path)
    with zipfile.ZipFile(built) as wheel:
        assert wheel.read(f"{info}/METADATA") == (tmp_path / info / "METADATA").read_bytes()


def test_types_are_right(tmp_path):
    """Of the package, by mypy where it is installed, and of what users write with it."""
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("there is no mypy")
    command = [sys.executable, "-m", "mypy", "--ignore-missing-imports", "--cache-dir",
               str(tmp_path / "cache")]
    package = ROOT / "framework" / "python"
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import tomlin\ntomlin.load('a.toml').run().status + 1\n")
    scripts = [str(path) for path in ROOT.glob("scenarios/*/*_notebook.py")]
    for files, is_right in (["--strict", str(package / "tomlin"), *scripts], True), ([str(wrong)], False):
        done = subprocess.run([*command, *files], cwd=tmp_path, capture_output=True, text=True,
                              env={**os.environ, "MYPYPATH": str(package)})
        assert (done.returncode == 0) == is_right, done.stdout + done.stderr


def arguments_of_module(function):
    """By the signature that pybind11 writes into the documentation of what it makes."""
    return len(re.findall(r"(?:self|arg\d+): ", function.__doc__.splitlines()[0]))


def test_stubs_have_the_signatures_of_the_module():
    from tomlin import _core

    tree = ast.parse((ROOT / "framework/python/tomlin/_core.pyi").read_text(encoding="utf-8"))
    checked = 0
    for node in tree.body:
        members = node.body if isinstance(node, ast.ClassDef) else [node]
        owner = getattr(_core, node.name) if isinstance(node, ast.ClassDef) else _core
        for one in members:
            if isinstance(one, ast.FunctionDef):
                found = arguments_of_module(getattr(owner, one.name))
                assert len(one.args.posonlyargs) + len(one.args.args) == found, one.name
                checked += 1
    assert checked > 20


def test_stubs_name_what_there_is():
    """Every name of the stub is in the module, and the other way round."""
    from tomlin import _core

    tree = ast.parse((ROOT / "framework/python/tomlin/_core.pyi").read_text(encoding="utf-8"))
    stub = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            stub[node.name] = {one.name if isinstance(one, ast.FunctionDef) else one.target.id
                               for one in node.body}
        elif isinstance(node, ast.FunctionDef):
            stub[node.name] = set()
        elif isinstance(node, ast.AnnAssign):
            stub[node.target.id] = set()
    assert set(stub) == {name for name in vars(_core) if not name.startswith("__")}
    for name, members in stub.items():
        thing = getattr(_core, name)
        if isinstance(thing, type):
            assert members - {"__init__"} == {one for one in vars(thing) if not one.startswith("_")}
