#!/usr/bin/env python3
"""The Debian packages of the program and of its Python module: what is in them, that the program runs
and draws out of them, and that they can be installed and run in a bare system.

usage: package_test.py BUILD_FOLDER [--bare-system]

Without --bare-system the packages are unpacked and the program run. With it a bare Debian 12 is made
by debootstrap, which takes root, a network and minutes: exit status 77, skipped, where that is not
possible.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
SUITE = "bookworm"


def output_of(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{command} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


def packages_of(build, folder):
    """The package of the program, and that of the module where it is built."""
    names = {"program": "tomlin"}
    if (build / "python" / "tomlin-plot").exists():
        names["python"] = "python3-tomlin"
    output_of("cpack", "--config", str(build / "CPackConfig.cmake"), "-B", str(folder),
              "-D", f"CPACK_COMPONENTS_ALL={';'.join(names)}", cwd=build)
    packages = []
    for name in names.values():
        found = list(folder.glob(f"{name}_*.deb"))
        assert len(found) == 1, found
        packages += found
    return packages


def contents_of(package):
    return {line.split(maxsplit=5)[5] for line in
            output_of("dpkg-deb", "--contents", package).splitlines()}


def check_contents(package):
    assert output_of("dpkg-deb", "--field", package, "Package").strip() == "tomlin"
    depends = output_of("dpkg-deb", "--field", package, "Depends")
    for library in ("libc6", "libstdc++6", "libhdf5"):
        assert library in depends, depends
    assert "python3-tomlin" in output_of("dpkg-deb", "--field", package, "Recommends")
    names = contents_of(package)
    for name in ("./usr/bin/tomlin", "./usr/share/doc/tomlin/README.md",
                 "./usr/share/doc/tomlin/LICENSE", "./usr/share/doc/tomlin/framework/USER_GUIDE.md",
                 "./usr/share/doc/tomlin/framework/guide/recipes.md",
                 "./usr/share/doc/tomlin/scenarios/rolling_ring/table_1_rigid.toml"):
        assert name in names, name
    strays = [name for name in names if name.endswith((".hpp", ".a", ".cmake"))]
    assert not strays, strays


def check_module(package):
    depends = output_of("dpkg-deb", "--field", package, "Depends")
    for needed in ("tomlin (=", "python3-numpy"):
        assert needed in depends, depends
    assert "python3-matplotlib" in output_of("dpkg-deb", "--field", package, "Recommends")
    names = contents_of(package)
    for name in ("tomlin-plot", "tomlin/__init__.py", "tomlin/_plots/draw.py", "tomlin/py.typed"):
        assert f"./usr/lib/tomlin/python/{name}" in names, name
    strays = [name for name in names if name.endswith(("/", ".pyc")) and "__pycache__" in name]
    assert not strays, strays


def check_run(root, draws):
    """Runs the program of an unpacked package, without anything of this environment."""
    with tempfile.TemporaryDirectory() as folder:
        program = str(root / "usr/bin/tomlin")
        environment = {"PATH": "/usr/bin:/bin"}
        output_of(program, "new", "pt", cwd=folder, env=environment)
        output_of(program, "run", "pt.toml", "-o", "out", cwd=folder, env=environment)
        assert '"status": "finished"' in (Path(folder) / "out/summary.json").read_text()
        if draws:
            output_of(program, "plot", "out", "-o", "force.svg", cwd=folder, env=environment)
            assert (Path(folder) / "force.svg").read_text().startswith("<?xml ")


def make_bare_system(suite, folder):
    if os.geteuid() != 0:
        skip("a bare system is made by root")
    if shutil.which("debootstrap") is None:
        skip("there is no debootstrap")
    root = folder / "root"
    made = subprocess.run(["debootstrap", "--variant=minbase", suite, str(root)],
                          capture_output=True, text=True)
    if made.returncode != 0:
        skip("debootstrap cannot make a bare system here: " + made.stdout[-500:])
    return root


def check_bare_system(packages, folder):
    root = make_bare_system(SUITE, folder)
    for package in packages:
        shutil.copy(package, root / "tmp")
    figures = len(packages) > 1
    output_of("chroot", str(root), "apt-get", "install", "-y", "--no-install-recommends",
              *(f"/tmp/{package.name}" for package in packages),
              *(["python3-matplotlib"] if figures else []))
    output_of("chroot", str(root), "sh", "-ec",
              "cd /tmp && tomlin new pt && tomlin run pt.toml -o out && "
              "grep -q '\"status\": \"finished\"' out/summary.json" +
              (" && tomlin plot out -o force.svg" if figures else ""))


def main():
    build = Path(sys.argv[1]).resolve()
    if shutil.which("cpack") is None or shutil.which("dpkg-deb") is None:
        skip("Debian packages are made by cpack and dpkg-deb")
    if not (build / "CPackConfig.cmake").exists():
        skip("tomlin is built as a part of another project")
    with tempfile.TemporaryDirectory() as folder:
        packages = packages_of(build, Path(folder))
        if sys.argv[2:] == ["--bare-system"]:
            check_bare_system(packages, Path(folder))
            return
        check_contents(packages[0])
        for module in packages[1:]:
            check_module(module)
        root = Path(folder) / "unpacked"
        for package in packages:
            output_of("dpkg-deb", "--extract", str(package), str(root))
        check_run(root, draws=len(packages) > 1)


if __name__ == "__main__":
    main()
