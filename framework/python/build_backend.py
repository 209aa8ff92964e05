"""The build back end of pyproject.toml (PEP 517, PEP 660): CMake makes the module, and this puts it
into a wheel. Nothing is needed but what CMake finds on the machine.

TOMLIN_JOBS limits parallel work, as for ./dev.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
TAG = (f"cp{sys.version_info.major}{sys.version_info.minor}-" * 2
       + sysconfig.get_platform().replace("-", "_").replace(".", "_"))


def version():
    """That of the project, from CMakeLists.txt."""
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(tomlin VERSION ([0-9.]+)", text).group(1)


def metadata():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = ["Metadata-Version: 2.1", "Name: tomlin", f"Version: {version()}",
             f"Summary: {project['description']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {one}" for one in project["dependencies"]]
    for extra, needs in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {one}; extra == "{extra}"' for one in needs]
    return "\n".join(lines) + "\n"


def build():
    """Makes build/python/tomlin for the interpreter that runs this."""
    configure = ["cmake", "-S", str(ROOT), "-B", str(BUILD),
                 f"-DPython_EXECUTABLE={sys.executable}", "-DTOMLIN_PYTHON=ON"]
    if not (BUILD / "CMakeCache.txt").exists():
        configure += ["-DCMAKE_BUILD_TYPE=Release", "-DTOMLIN_TESTS=OFF", "-DTOMLIN_BENCHMARKS=OFF"]
        if shutil.which("ccache"):
            configure.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        configure += ["-G", "Ninja" if shutil.which("ninja") else "Unix Makefiles"]
    subprocess.run(configure, check=True, cwd=ROOT, stdout=sys.stderr)
    jobs = os.environ.get("TOMLIN_JOBS") or str(os.cpu_count())
    subprocess.run(["cmake", "--build", str(BUILD), "--target", "python", "--parallel", jobs],
                   check=True, cwd=ROOT, stdout=sys.stderr)


def write_wheel(folder, files):
    """`files`: contents by their names in the wheel."""
    name = f"tomlin-{version()}-{TAG}.whl"
    info = f"tomlin-{version()}.dist-info"
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/WHEEL"] = ("Wheel-Version: 1.0\nGenerator: tomlin\nRoot-Is-Purelib: false\n"
                              f"Tag: {TAG}\n").encode()
    record = ""
    with zipfile.ZipFile(pathlib.Path(folder) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record += f"{path},sha256={digest},{len(content)}\n"
        wheel.writestr(f"{info}/RECORD", f"{record}{info}/RECORD,,\n")
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Without which pip builds twice."""
    info = pathlib.Path(metadata_directory) / f"tomlin-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata(), encoding="utf-8")
    return info.name


prepare_metadata_for_build_editable = prepare_metadata_for_build_wheel


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build()
    package = BUILD / "python" / "tomlin"
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    return write_wheel(wheel_directory, {
        f"tomlin/{path.relative_to(package)}": path.read_bytes()
        for path in sorted(package.rglob("*"))
        if path.suffix in (".py", ".pyi", ".typed") or path.name == "py.typed"
        or path.name.endswith(suffix)})


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    build()
    return write_wheel(wheel_directory, {"tomlin.pth": f"{BUILD / 'python'}\n".encode()})


def build_sdist(sdist_directory, config_settings=None):
    base = f"tomlin-{version()}"
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True,
                           capture_output=True, text=True).stdout.split("\0")
    with tarfile.open(pathlib.Path(sdist_directory) / f"{base}.tar.gz", "w:gz",
                      format=tarfile.PAX_FORMAT) as archive:
        for name in filter(None, files):
            archive.add(ROOT / name, f"{base}/{name}")
        (BUILD / "PKG-INFO").parent.mkdir(exist_ok=True)
        (BUILD / "PKG-INFO").write_text(metadata(), encoding="utf-8")
        archive.add(BUILD / "PKG-INFO", f"{base}/PKG-INFO")
    return f"{base}.tar.gz"
